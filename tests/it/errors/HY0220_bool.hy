agent Lamp {
  state x = 0
  discrete lit = true
  flow { x' = 1 }
  off: when x >= 1 { lit := false }
}
