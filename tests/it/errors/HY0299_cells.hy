// --limit max_cells=6
agent Car { state x = 0, y = 0  flow { x' = 1  y' = 1 } }
system { cars = Car[4]() }
run { until 1  record cars every 1 to "cars.csv" }
