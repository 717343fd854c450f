// --limit max_modes=2
agent Car { state x = 0  flow { x' = 1 }
  initial mode A { when x >= 1 -> B }
  mode B { when x >= 2 -> C }
  mode C { }
}
system { car = Car() }
run { until 1 }
