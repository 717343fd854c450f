agent Car(v: real) { }
system { cars = Car[](v = 1) }
