param a = 0/0
let b = 1e308 [km]
agent Car(v: real) { state x = 1/v flow { x' = 1 } }
