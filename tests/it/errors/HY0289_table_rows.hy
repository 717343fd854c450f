// --limit max_table_rows=2
agent A { state x = 0  flow { x' = table("wind.csv", "speed", time) } }
