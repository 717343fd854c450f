agent Car { event hit(v: real [m/s], hard: bool)  after 1 [s] { emit hit(3)  emit hit(3 [m], true)  emit hit(3, 4) } }
agent Log {
  discrete v = 0, w: real [m] = 0
  on hit(u) { v := u }
  on hit(u, u) { v := u }
  on hit(u, hard) when hard and rising(u > 3) { w := u }
}
