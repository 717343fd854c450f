agent A { sate x, y }
// ----
agnet Car { }
// ----
agent A {
  state x
  invarient x > 0
}
// ----
agent A { when x > 0 { destory self } }
// ----
run { untill 30 [s]
      recrod x to "a.csv" }
// ----
agent A { mode M { flw { x' = 1 } } }
// ----
interaction I(a: A, b: A) { wen a.x > b.x { } }
// ----
model M { }
// ----
def f(x) = 3
// ----
function f(x: real) = 3
// ----
const k = 3
// ----
include "cars.hy"
// ----
simulate 10
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  var y = 0
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  real y = 0
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  const k = 3
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  parameter k = 3
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  init { x = 3 }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  equations { }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  noise x
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  if x > 1 { x := 0 }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  location B { }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  def f(x) = 3
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  goto B
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  for i in 1:3 { }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 goto B
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { var y = 3 }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { if x > 2 { x := 0 } elif x < 3 { x := 1 } }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { print(x) }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { spawn A() }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { kill self }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { send ping }
}
// ----
agent A {
  state x = 0
  flow { x' = 1 }
  when x > 1 { quit }
}
// ----
agent A { flow { der(x) = 1 } }
// ----
agent A { flow { dx/dt = 1 } }
// ----
property p = alwasy x > 0
// ----
property p = always exist o in A: o.x > 0
