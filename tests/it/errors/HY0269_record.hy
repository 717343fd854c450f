agent Car { state x = 0  flow { x' = 1 } }
system { cars = Car[3]()  none_yet = Car[0]() }
run { until 1  record cars[5].x every 0.1 to "cars.csv" }
