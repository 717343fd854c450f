agent Car {
  state x = 0
  flow { x' = 1 }
  initial mode Go { flow { x' = 2 } }
}
