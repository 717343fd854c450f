agent Car(v: real) { }
system { a = Car[3] from csv("latin1.csv")
         b = Car[3] from csv("empty.csv")
         c = Car[] from csv("quote.csv") }
