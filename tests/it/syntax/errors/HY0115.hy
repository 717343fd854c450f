let x = f(a = 3)
// ----
system { a = Car(3, 4) }
// ----
system { a = Car(v) }
// ----
system { a = Car[3](v = 3, w) }
// ----
agent A { flow { x' = sin x } }
// ----
let y = (sqrt 2) + 1
