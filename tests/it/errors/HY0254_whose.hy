agent Car { state x = 0 flow { x' = 1 } }
interaction Bump(a: Car, b: Car) { when a.x > b.x { x := 0 } }
