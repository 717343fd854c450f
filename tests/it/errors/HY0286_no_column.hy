agent A { state x = 0  flow { x' = table("wind.csv", "sped", time) } }
