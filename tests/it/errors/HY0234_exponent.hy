// exponents
param n = 2
param t: real [s] = 3
fn hill(c: real, k: real, p: real) = c^p/(k^p + c^p)

agent A(m: real) {
  state x: real [m] = 0, y = 0
  flow { x' = 1  y' = 2^x + 2^(x/3 [m]) }
  when x^n > 4 [m^2] and x^(1/3) > 1 [m^3] { }
  when x^y > 1 or x^t > 1 { }
  when x^pi > 1 { }
  when x^m > 1 [s] and y^x > 0 { }
  when hill(x, 3 [m], 4) > x { }
  when hill(x, t, n) > 0 { }
}
