// ball.hy: two balls fall, bounce, and lose a fifth of their speed each time.
param g: real [m/s^2] = 9.81

agent Ball(h: real [m], e: real) {
  state x: real [m] = h, v: real [m/s] = 0
  flow { x' = v
         v' = -g }
  bounce: when x <= 0 { v := -e*v }
}

system {
  rubber = Ball(h = 1, e = 0.8)
  steel  = Ball(h = 2, e = 0.6)
}
run { until 2.5 [s]  record rubber, steel every 0.01 [s] to "balls.csv" }
