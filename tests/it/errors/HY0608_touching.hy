agent Car {
  state x = 0, y = 0
  flow { x' = 1  y' = 0 }
  origin: when x^2 + y^2 <= 0 { x := 1 }
  line:   when y <= 1 and abs(x - 1) <= 0 { x := 2 }
  event_: when crossing(x^2) { x := 3 }
}
interaction Meet(a: Car, b: Car) { hit: when hypot(a.x - b.x, a.y - b.y) <= 0 { a.x := 1  b.x := 0 } }
system { cars = Car[2](x = index) }
