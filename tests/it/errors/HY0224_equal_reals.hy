agent Car {
  state x = 0
  discrete n: int = 0, level = 2
  let far = x + 1
  flow { x' = 1 }
  when x == 3 { n := 1 }
  when n != 2 and far != level { n := 2 }
  when level == 2 { level := 3 }
}
