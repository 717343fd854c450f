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
// ----
system { a = Car(v = 4, ) }
// ----
agent A { flow { x' = 3, y' = 4 } }
// ----
agent A { when x > 0 -> }
// ----
agent A { initial Spiral { } }
// ----
agent A() { state x: [m] }
// ----
let x = if a then b
// ----
agent A { when x > 0 then x := 3 }
// ----
run { until 30 [s], tolerance 1e-3 }
// ----
run { record x every 3 to x.csv }
// ----
run { tolerance = 1e-3 }
// ----
let x = exists o in Car o.x > 0
// ----
let x = sum(1, 2)
// ----
agent A { state x = 1, 2 }
// ----
interaction I { }
// ----
agent A { when x > 0 { a.b.c := 3 } }
// ----
agent A { flow { x'' = 3 } }
// ----
agent A { x' = 3 }
// ----
system { Car(v = 3) }
// ----
let f(x) = 3
// ----
param x: real
// ----
let x = 3; y = 4
// ----
agent A { entry x := 3 }
// ----
system { a = new A() }
// ----
agent A { when x > 1 { create new B(v = 3) } }
// ----
let y = 1 if c else 2
// ----
agent A { when x > 1 { x := 1 if x > 3 else 2 } }
// ----
fn f(x) = x
// ----
agent A(v = 3) { }
// ----
interaction I(a, b) { }
// ----
run { until: 1 }
// ----
run { until = 1 }
// ----
run { tolerance: 1e-6 }
// ----
agent A { state x [m/s] = 3 }
// ----
param k [m] = 3
