agent Car(k: real) {
  state x = 0
  discrete n = 0
  flow { x' = 1  k' = 2  n' = 3  z' = 4 }
}
