// A number that depends on a quantifier.
fn weight(crowded: bool) = if crowded then 2 else 1
agent Car {
  state x = 0
  flow { x' = 1 }
  wrap: when x >= 10 { x := weight(exists o in other Car: o.x < 1) }
}
system { cars = Car[2] }
run { until 1 }
