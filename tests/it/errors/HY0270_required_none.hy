agent Car(lead: Car) { }
system { cars = Car[3](lead = if index > 0 then cars[index - 1] else none) }
