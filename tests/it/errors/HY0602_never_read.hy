agent Car {
  state x = 0
  discrete full: bool = false, idle: int = 0, hits: int = 0, seen: real = 0
  flow { x' = 1 }
  far: when x >= 5 { full := true  hits := hits + 1  seen := time  x := 0 }
}
system { cars = Car[2]() }
run { until 10  record Car.seen every 1 to "seen.csv" }
