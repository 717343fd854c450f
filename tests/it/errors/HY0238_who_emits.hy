agent A { event hit  state x = 0  flow { x' = 1 } }
interaction Touch(a: A, b: A) { when a.x >= b.x + 1 { emit hit  emit c.hit  emit a.hit } }
