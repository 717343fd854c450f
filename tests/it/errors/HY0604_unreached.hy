// B and C lead to each other, but nothing leads to them; D is entered by an interaction, E is where one starts
agent Car {
  state x = 0
  flow { x' = 1 }
  initial mode A { }
  mode B { there: when x >= 1 -> C }
  mode C { back: when x >= 2 -> B }
  mode D { }
  mode E { }
}
interaction Meet(a: Car, b: Car) { when a.x - b.x >= 1 { if a.x >= 3 { a -> D } } }
system { first = Car(x = 1)  second = Car() in E }
