agent Car {
  state x = 0
  link lead: Car
  flow { x' = 1 }
  when x > 1 { lead.x := 0 }
}
