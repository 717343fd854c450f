// Every function uses its condition four times, so the last one has 4^7 comparisons.
fn c0(x: real) = x > 1 or x < -1
fn c1(x: real) = if c0(x) then c0(x + 1) else c0(x + 2)
fn c2(x: real) = if c1(x) then c1(x + 1) else c1(x + 2)
fn c3(x: real) = if c2(x) then c2(x + 1) else c2(x + 2)
fn c4(x: real) = if c3(x) then c3(x + 1) else c3(x + 2)
fn c5(x: real) = if c4(x) then c4(x + 1) else c4(x + 2)
fn c6(x: real) = if c5(x) then c5(x + 1) else c5(x + 2)
fn c7(x: real) = if c6(x) then c6(x + 1) else c6(x + 2)
agent Car {
  state x = 0
  flow { x' = 1 }
  pass: when c7(x) { x := 0 }
}
system { car = Car }
run { until 1 }
