system { a = Car(v = 4 rho = 2) }
// ----
fn f(a: real) a + 1
// ----
agent A { state x = if a then 1 }
// ----
agent A { when x > 0 { if x > 0 then 1 else 2 } }
// ----
agent A { when -> M }
// ----
let x = 3 +
// ----
run { until }
// ----
agent A { 3 }
// ----
property p = always [0 5] x > 0
// ----
let x = a < not b
// ----
agent A { let y = if x > 0 { 1 } else { 2 } }
// ----
system { a = 3 }
// ----
run { record x }
// ----
agent A { when x > 0 { x } }
// ----
agent A { when x > 0 x := 3 }
// ----
system { a = A, b = B }
// ----
let
// ----
3
