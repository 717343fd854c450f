agent Car(v: real) { }
system { a = Car[3] from csv("two_columns.csv") }
