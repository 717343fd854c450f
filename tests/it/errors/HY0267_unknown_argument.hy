agent Car(v: real) { state x = 0 let gap = 3 flow { x' = v } }
system { car = Car(v = 1, vx = 2, gap = 3) }
