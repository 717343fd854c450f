agent A { when a > 0 { x = 3 } }
// ----
agent A { flow { x = 3 } }
// ----
agent A { flow { x' := 3 } }
// ----
let x := 3
// ----
agent A { when x = 3 { } }
// ----
agent A { when a > 0 { x == 3 } }
// ----
system { a = Car(v := 3) }
// ----
param x == 3
// ----
agent A { flow { x' = v y = 3 } }
// ----
run { stop when x = 3 }
// ----
let y = if x = 3 then 1 else 2
