// delays, periods, the end of the run
param d: real [m] = 3
agent A {
  state x: real [m] = 0
  flow { x' = 1 }
  after d { }
  every 10 [1/s] { }
  after 3 [s]*d/d when x > 0 { }
}
system { a = A() }
run { until 3 [km/h]  record a every d to "a.csv" }
