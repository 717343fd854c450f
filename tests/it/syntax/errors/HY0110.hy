agent A { state flow: real }
// ----
param state = 3
// ----
let table = 3
// ----
agent A { flow { time' = 1 } }
// ----
agent mode { }
// ----
agent A { when a > 0 { self := 3 } }
// ----
fn f(rate: real) = rate
// ----
system { run = Car }
// ----
agent A { initial mode initial { } }
// ----
let x = exists state in Car: true
