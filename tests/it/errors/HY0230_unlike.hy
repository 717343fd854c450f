// sums, comparisons, branches; once for each mistake, with the declarations and literals behind it
param L: real [km] = 2
param k = 3                                    // without a unit: unchecked
let   lag = 10 [ms]
fn square(a: real, b: real) = a^2 + b^2
fn twice(a: real, b: real) = 2*square(a, b)

agent Car(v0: real [km/h]) {
  state x: real [m] = 0, v: real [m/s] = v0, free = 0
  link lead: Car
  let gap = if lead then lead.x - x else 0
  let bad = x + v
  let after_it = bad + time                    // no second error
  flow { x' = v  v' = 0.5 [1/s]*(v0 - v)  free' = x + k*v + free*v }
  assert gap < v
  when gap - 5 <= v*lag and L > x + lag { }
  when min(x, v) > 0 or max(3, x) > 0 { }
  when clamp(x, v, 3) > 0 or mod(x, 2 [s]) > 0 or hypot(x, v) > atan2(x, v) { }
  when (if lead then x else v) > 3 or twice(x, v) > 0 { }
  when twice(v, x) > 0 and twice(x, L) > 0 { }   // the first place has been reported, the second is right
  when crossing(x - 2 [deg]) and sin(x/L) > x { }
}
interaction Bump(a: Car, b: Car) {
  let d = a.x - b.x
  when d^2 + d <= 4 { }
}
