agent Car(lead: Cat) {
  state x: float = 0
  flow { x' = 1 }
}
system { cars = Cars[3] }
