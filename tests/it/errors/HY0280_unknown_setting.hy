agent Car { }
run { until 3 tolerence 1e-6 stats to "stats.json" }
