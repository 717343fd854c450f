agent Car(v: real [km/h], lane: int) { }
agent Van(lit: bool) { }
system { a = Car[] from csv("text.csv")
         b = Car[] from csv("many.csv")
         c = Car[] from csv("half.csv")
         d = Van[] from csv("truth.csv") }
