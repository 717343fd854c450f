let a = 1 + true
let b = sin("x")
agent Car { state x = 0 let d = (2*x)' flow { x' = 1 } when not x < true { x := 0 } }
