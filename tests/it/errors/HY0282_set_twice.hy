run { until 3 until 4 seed 1 seed 2 }
