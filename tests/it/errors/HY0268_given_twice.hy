agent Car(v: real) { state x flow { x' = v } }
system { a = Car(v = 1, x = 0, v = 2)
         b = Car(v = 1) from csv("cars.csv") }
