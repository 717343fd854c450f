agent Car {
  state x = 0
  let up = rising(x > 0)
  flow { x' = 1 }
  when if crossing(x) then true else false { x := 0 }
}
