agent Car(v: real) { state x flow { x' = v } }
system { cars = Car[5] from csv("cars.csv") }
