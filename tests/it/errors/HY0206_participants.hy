agent A { state x = 0  flow { x' = 1 } }
interaction None() { when time >= 1 { } }
interaction Alone(a: A) { when a.x >= 1 { a.x := 0 } }
interaction Three(a: A, b: A, c: A) { when a.x >= b.x { c.x := 0 } }
