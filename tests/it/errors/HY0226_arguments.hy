fn f(a: real, b: real = 2) = a + b
let a = f()
let b = atan2(1)
let c = f(1, 2, 3)
