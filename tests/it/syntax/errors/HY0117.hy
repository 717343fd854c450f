agent A { sate x, y }
// ----
agnet Car { }
// ----
agent A {
  state x
  invarient x > 0
}
// ----
agent A { when x > 0 { destory self } }
// ----
run { untill 30 [s]
      recrod x to "a.csv" }
// ----
agent A { mode M { flw { x' = 1 } } }
// ----
interaction I(a: A, b: A) { wen a.x > b.x { } }
