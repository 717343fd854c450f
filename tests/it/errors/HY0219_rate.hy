// a hazard is a finite number, and not a negative one
agent A {
  discrete n: int = 0
  down: rate 2 [1/s] - 3 [1/s] { n := n + 1 }
  never: rate inf { n := n + 1 }
  fine: rate 0 { n := n + 1 }
}
system { a = A() }
run { until 3 }
