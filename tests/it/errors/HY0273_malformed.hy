agent Car(v: real) { }
system { a = Car[3] from csv("two_columns.csv")
         b = Car[3] from csv("empty.csv")
         c = Car[] from csv("long_row.csv") }
