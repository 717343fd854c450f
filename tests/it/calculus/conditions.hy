// Conditions in normal form: negations, quantifiers, distances, links, modes, events.
fn distance(p: Car, q: Car) = hypot(p.x - q.x, p.y - q.y)
fn inside(p: Car, r: real) = sqrt(p.x^2 + p.y^2) < r

agent Car(reach: real) {
  state x = 0, y = 0
  discrete lane: int = 1, open: bool = true
  link lead: Car
  let close = if lead then distance(self, lead) <= reach else false
  let fast = x' > 2
  flow { x' = 1 }
  initial mode Drive { flow { y' = sin(time) } }
  mode Park { flow { y' = 0 } }
  near: when exists o in other Car where o.lane == lane: distance(self, o) <= 5 -> Park
  alone: when forall o in other Car where o.lane == lane and o is Drive: distance(self, o) > reach { lane := lane + 1 }
  neither: when not (x <= 1 or not open and not inside(self, 3)) { open := not open }
  either: when if open then x > 1 else y > 1 { open := x > y }
  both: when (x > 1) == open and lane != 3 { }
  linked: when not close or lead == self or lead.lead.x > x and lead.lane != lane { }
  events: when rising(x > 1 or y > 1) and open or crossing(x - y) { }
  speed: when fast and not (x' + y' >= 5) { }
  jumps: when mod(x, 2) >= 1 and floor(y) > 1 { }
  opened: when atan2(y, x) < 0 or (if x > y then x else -y) + 1 <= 0 or sign(x) < y { }
  later: after 2*reach when x > 1 priority 3 - lane { if x > 2 { x := 0 } else { y := 0 stop "done" } }
  often: every 0.5 { x := x + 1 }
}
system { cars = Car[3](reach = 2) }
run { until 1 }
