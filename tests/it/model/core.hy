// core.hy: what the core of the language has and the models in models/ do not show.
param n: int = 4                                 // overridden by the test
param top: real [km/h] = 180
param name: string = "core.csv"
param lit = true
let   ramp = 2 [m/s^2]*time                   // follows time: shared by those that read it
let   half = n/2
fn scaled(v: real [km/h], times: int = 2) = v*times
fn ahead(me: Car, it: Car): real [m] = if it then it.x - me.x else inf

agent Car(v0: real [km/h] = 36, k: int = index, boss: Lamp) {
  state x: real [km] = 2*y, y = k^2 + v0, z: real [cm] = -5
  discrete lane: int = mod(k, 2), lit: bool, gain = 0.5
  link lead: Car
  link back: Car
  let gap = ahead(self, lead)
  let sure = if lead and lead.x > x then lead.x - x else 0
  flow { x' = scaled(36) + boss.level + ramp
         y' = if not lead then 0 else lead.x' + 1 [1/s]*sure }
  assert gap > 0 or not lead "too near"
  entry { lane := 0 }
  exit { lane := 1 }
  initial mode Go {
    let twice = 2*gap
    flow { z' = min(lane, 2) }
    invariant z >= -10
    entry { z := 5 }
    when twice < 3 -> Stop
    when twice < 2 -> Stop { x := 1 }
    soon: after 2*gain when rising(x > 3) and not crossing(y - 1) priority lane + 1 -> Go
    every 10 [ms] { if lit { y := 1 } else if lane == 1 { y := 2 z := 3 } else { stop "dark" } }
  }
  mode Stop {
    flow { z' = 0 }
    see: when lead != back and exists o in other Car where o.lane == lane: abs(o.x - x) < 3 and o is Go
         priority o.k -> Go { y := o.y }
  }
  when forall o in Car where o != self: o.lane == lane and lead == none -> Stop
  when boss is On { gain := 2 }
}

agent Lamp { state level = 1 flow { level' = 0 } initial mode Lamp { } mode On { } }
agent Nothing { }

interaction Meet(a: Car, b: Lamp) {
  let d = a.x - b.level
  near: when d^2 + d*b.level <= 1 and b is On { a.x := d  b -> On  a -> Stop  if a.lit { b.level := 0 } }
  when crossing(d) { a.y := -d }
}

system {
  first = Car(lead = cars[n - 1], lit = true, boss = lamp) in Stop
  cars  = Car[n](lead = if index > 0 then cars[index - 1] else first, v0 = 36 + index, lit = index < half, boss = lamp)
  rows  = Car[](boss = lamp, back = none) from csv(name)
  lamp  = Lamp()
  none_at_all = Nothing[0]
}
run { until 2 [min] seed 7 absolute 1e-9 record cars[1], first.gap, Lamp.level every 1 [s] to "core_out.csv" record Car.lead to "b.csv" }
