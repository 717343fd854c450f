agent Car(v: real) { state x = 1/v flow { x' = 1 } }
system { cars = Car[3](v = 1 - index) }
