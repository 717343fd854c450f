// --tolerance 0
run { until -1 absolute 0 seed 1.5 }
