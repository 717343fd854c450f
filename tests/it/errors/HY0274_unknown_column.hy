agent Car(speed: real) { state x = 0 flow { x' = speed } }
system { cars = Car[] from csv("columns.csv") }
