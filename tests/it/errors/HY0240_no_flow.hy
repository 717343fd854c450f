agent Car {
  state x = 0, v = 0
  flow { x' = v }
  initial mode Go { flow { v' = 1 } }
  mode Coast { }
  mode Stop { }
}
agent Ball { state h = 1 }
