agent Car { state x = index  link lead = nearest o in other Car by o.x - x  flow { x' = if lead then 1 else 2 } }
agent Maker { make: every 1 { create Car(lead = none) } }
system { cars = Car[2](lead = cars[0])  maker = Maker() }
