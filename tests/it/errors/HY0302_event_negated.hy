// The negation of an event holds nearly always.
agent Car {
  state x = 0
  flow { x' = 1 }
  pass: when not crossing(x - 1) { x := 0 }
}
system { car = Car }
run { until 1 }
