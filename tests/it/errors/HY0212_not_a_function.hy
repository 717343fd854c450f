param g = 9.81
let a = g(3)
let b = sinn(3)
