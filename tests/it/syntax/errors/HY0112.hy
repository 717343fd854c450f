let a = 3 [ ]
// ----
let a = 3 [m, s]
// ----
agent A { state x: real [m > s] }
