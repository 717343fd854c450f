agent Car {
  state x = 0
  discrete k = 0
  flow { x' = sin(t) }
  one: when x >= 1 { k := i }
  two: when x >= e { x := x + dt*k }
}
