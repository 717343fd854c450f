// Kinks of flows become locks.
agent Ball {
  state x = 0, y = 1, z = 0
  discrete k = 2
  flow { x' = abs(y) - min(x, 1)
         y' = if x > 1 and k > 1 then -floor(z) else clamp(y, -1, 1)
         z' = atan2(y, x) + mod(time, 2) + max(k, 1) + sign(x) }
}
system { ball = Ball }
run { until 1 }
