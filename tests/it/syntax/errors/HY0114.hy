let x = 0 < a < 1
// ----
let x = a == b == c
