agent A { state x = 0  flow { x' = table("columns.csv", "v", time) } }
