// what discrete variables are never given, what squares never are, what is rising from the start
agent Car {
  state x = 0
  discrete gear: int = 1, lit: bool = false
  flow { x' = 1 }
  initial mode Drive {
    shift: when x >= 1 and gear >= 3 -> Stop { gear := 2 }
    dark:  when lit and x >= 2 -> Stop
    below: when x^2 + 1 <= 0 or abs(x) < 0 -> Stop
    here:  when self is Stop -> Stop
    rise:  when rising(x^2 >= 0) -> Stop
    done:  when x >= 9 -> Stop
  }
  mode Stop { }
}
interaction Meet(a: Car, b: Car) { near: when (a.x - b.x)^2 < 0 { a.x := 0  b.x := 0 } }
system { cars = Car[2]() }
