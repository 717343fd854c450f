import "HY0214_circle.hy"
agent A { state x = 0  flow { x' = 1 } }
