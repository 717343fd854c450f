param k: integer = 3
param lit: boolean = true
param file: str = "a.csv"
param wait: duration = 3
agent Car {
  state x: float = 0, v: vector
}
