agent Car(speed: real) { state x = 0 flow { x' = speed } }
agent Van(v: real) { }
system { cars = Car[] from csv("columns.csv")  vans = Van[] from csv("unnamed.csv") }
