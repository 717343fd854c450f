param N = 3
agent Car(v: real) { }
system { cars = Car[2](v = 1) one = Car(v = 2) }
run { until 1 record N, carrs, cars[1], one[0], 3 + 4 to "out.csv" }
