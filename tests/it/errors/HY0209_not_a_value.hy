fn twice(x: real) = 2*x
agent Car {
  state x = 0
  flow { x' = twice + Car.x }
  when cars[0].x > 1 { x := 0 }
}
system { cars = Car[2] }
