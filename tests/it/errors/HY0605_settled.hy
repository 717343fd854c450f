param lanes: int = 3
param patience = inf
agent Car {
  state x = 0
  flow { x' = 1 }
  initial mode Right {
    pass: when x >= 1 and lanes > 3 -> Left
    slow: after patience -> Left
  }
  mode Left { back: every 2 when 2*lanes <= 5 -> Right }
}
interaction Meet(a: Car, b: Car) { touch: when lanes == 1 and a.x - b.x >= 1 { a.x := 0  b.x := 0 } }
