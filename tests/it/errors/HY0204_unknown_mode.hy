agent Car {
  initial mode Cruise { when time > 3 -> Brakes }
  mode Brake { when exists o in other Car: o is Crash -> Cruise }
}
system { car = Car() in Bake }
