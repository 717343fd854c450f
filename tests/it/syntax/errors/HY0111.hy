param T = 3
run { until T [s] }
// ----
let a = x^2 [m]
// ----
agent A { every T [ms] { x := 0 } }
// ----
let v = (a + b) [m/s]
// ----
let v = a [m/s^2]
// ----
agent A { after 2*T [s] -> B }
// ----
run { tolerance eps [s] }
