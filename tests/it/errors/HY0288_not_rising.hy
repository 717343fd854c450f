agent A { state x = 0  flow { x' = table("jump.csv", "speed", time) } }
