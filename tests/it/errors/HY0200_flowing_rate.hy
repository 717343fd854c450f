fn gap(a: A, b: A) = abs(a.x - b.x)
agent A { state x = 0  let k = 2*x  flow { x' = 1 } }
interaction Meet(a: A, b: A) {
  far: rate 1/(1 + gap(a, b)) { a.x := 0  b.x := 0 }
  own: rate a.k { a.x := 0 }
  late: rate time { a.x := 0 }
}
