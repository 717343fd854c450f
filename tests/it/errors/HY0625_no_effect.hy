agent Car {
  state x = 0
  flow { x' = 1 }
  half: when x >= 0.5
  when x >= 0.7
  when x >= 0.8 { }
  after 1
}
interaction Meet(a: Car, b: Car) { when a.x > b.x }
system { cars = Car[3]() }
run { until 1 }
