agent Car { state x = 0 flow { x' = x.speed } }
