// functions, priorities, counts and settings of pure numbers
param L: real [m] = 4
fn wave(x: real) = sin(x)

agent A {
  state x: real [m] = 0
  flow { x' = 1 }
  when sin(x) > 0 and exp(-x/L) > 0 and log(x/1 [m]) > 0 { }
  when cos(2 [Hz]*x) > 0 priority x { }
  when wave(x/L) > 0 and wave(2*x) > 0 and sin(5 [s]) > 0 { }
}
system { as = A[L]() }
run { until 1  tolerance 3 [m] }
