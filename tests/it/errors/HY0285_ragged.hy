agent Car(v: real) { }
agent Van(v: real, lane: int) { }
system { c = Car[] from csv("long_row.csv")
         d = Van[] from csv("short.csv") }
