agent A {
  event call
  state x = 0
  flow { x' = 1 }
  every 1 { emit call }
}
interaction Meet(a: A, b: A) { loud: on call { a.x := 0 } }
