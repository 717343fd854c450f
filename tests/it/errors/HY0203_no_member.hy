agent Car {
  state speed = 0
  link lead: Car
  flow { speed' = 0 }
  initial mode Go { let margin = 3 }
  when lead.sped > 1 or lead.margin > 2 { speed := 0 }
}
