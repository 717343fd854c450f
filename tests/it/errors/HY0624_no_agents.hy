// nothing of it runs
agent Car { state x = 0  flow { x' = 1 } }
run { until 1 }
