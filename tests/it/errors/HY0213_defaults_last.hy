fn f(a: real = 1, b: real) = a + b
