agent A {
  flow { x' = 1

system { a = A }
// ----
let x = (a + b
// ----
let x = f(a, [1, 2)
// ----
agent A { mode M { when x > 0 -> M }
