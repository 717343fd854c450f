agent Car(v: real) { }
system { cars = Car[3] from csv("nowhere.csv") }
