// A number that depends on a quantifier.
agent Car {
  state x = 0
  flow { x' = 1 }
  wrap: when x >= 10 { x := if exists o in other Car: o.x < 1 then 2 else 0 }
}
system { cars = Car[2] }
run { until 1 }
