param N = 3
agent N { }
agent Car(x: real) {
  state x = 0
  flow { x' = 0 }
  initial mode Go { let gap = 1 again: when gap > 2 { x := 1 } }
  mode Go { again: when x > 3 { x := 2 } }
}
