param a = b + 1
param b = f(2)
fn f(x: real) = x + c
let c = a
agent Car {
  state x = v, v = 2*x
  link lead: Car
  let gap = lead.far
  let far = 2*gap
  flow { x' = v'
         v' = 3 + x' }
}
