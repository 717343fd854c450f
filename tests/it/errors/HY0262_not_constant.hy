param a = time
agent Car { state x = 0 flow { x' = 1 } }
system { cars = Car[3](x = time) }
run { until time }
