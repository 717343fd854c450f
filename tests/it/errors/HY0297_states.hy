// --limit max_states=2
agent Car { state x = 0, y = 0, z = 0  flow { x' = 1  y' = 1  z' = 1 } }
system { car = Car() }
run { until 1 }
