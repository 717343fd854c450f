agent Car {
  state x = 0, y = 0
  flow { x' = 1 y' = 1 }
  when x > 1 { x := 0 if y > 1 { y := 1 } else { y := 2 } y := 3 x := 4 }
}
interaction Bump(a: Car, b: Car) { when a.x > b.x { a.x := 1 b.x := 2 a.x := 3 } }
