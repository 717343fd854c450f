let x = 1.
// ----
let x = .5
// ----
let x = 3x
// ----
let x = 1e
// ----
let x = 1_000
// ----
let x = 1.2.3
// ----
let x = 0x1f
// ----
agent A { after 1 s { x := 0 } }
// ----
agent A { after 1 second -> B }
// ----
agent A { flow { x' = 1 m/s } }
// ----
run { until 30 min }
// ----
let z = 3 y
