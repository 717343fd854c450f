agent Car {
  state x = 0
  flow { x' = if x then 1 else 0 }
  when x - 3 { x := 0 }
}
