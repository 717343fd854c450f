agent Car(name: string, lead: Car = none) {
  state n: int = 0
  discrete boss: Car
  link front
  let l = lead
}
interaction Bump(a: Car, b: real) { }
