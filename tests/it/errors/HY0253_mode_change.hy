agent Car {
  initial mode Go { when time > 1 { car -> Stop } }
  mode Stop { }
}
interaction Bump(a: Car, b: Car) { when time > 1 -> Stop }
