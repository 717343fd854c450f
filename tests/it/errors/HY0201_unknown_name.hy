param road = 2000
agent Car(v: real) {
  state x = 0
  flow { x' = velocity }
  leave: when x >= raod { x := 0 }
}
