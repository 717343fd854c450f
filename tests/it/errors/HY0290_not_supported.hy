agent A { state x = 0  flow { x' = 1 } }
interaction Touch(a: A, b: A) { rate 2 [1/s] { a.x := 0 } }
