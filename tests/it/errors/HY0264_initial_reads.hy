agent Car(a: real = b, b: real = 2) {
  state x = gap, y = time
  link lead: Car
  let gap = 3
  flow { x' = 1 y' = 1 }
}
agent Van { state x = 0 link lead: Van discrete y = lead.x flow { x' = 1 } }
