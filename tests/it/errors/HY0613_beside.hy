// bare numbers in SI beside what is in another unit; zero is zero
param limit: real [km/h] = 130
fn over(v: real [km/h]): real [km/h] = v - 5 - limit
agent Car {
  state x: real [km] = 0, v: real [km/h] = 120, a: real [m/s] = 3
  discrete wait: real [min] = 5, turn: real [deg] = 90
  let far: real [km] = if v > 0 then 3 else x
  flow { x' = 30  v' = 0  a' = 1 }
  slow: when v < 50 or x - 2 > 7 { v := 60  wait := max(wait, 3) }
  when v > 50 [km/h] and a > 50 and turn > 45 and over(v) > 0 and far >= 3 { v := 60 + v }
}
system { c = Car() }
run { until 10 }
