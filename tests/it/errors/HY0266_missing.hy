agent Car(v: real, boss: Car) { state x flow { x' = v } }
system { car = Car() }
