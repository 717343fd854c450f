// near_miss.hy: the two cars of two_cars.hy, one of them a little further up: they pass each other 1.0014 m apart.
// Shows that a guard which comes within 2 mm of its boundary and turns back is no event.

param R: real [m] = 1.0                      // avoidance range
param y0: real [m] = -1.16                   // with -1.2 they come too close, at t = 6.83

fn dist2(a: Car, b: Car) = (a.x - b.x)^2 + (a.y - b.y)^2

agent Car(v: real [m/s], rho: real [m], k: real [m]) {
  state x: real [m], y: real [m], th = 0
  flow { x' = v*cos(th)
         y' = v*sin(th) }
  initial mode Spiral {
    flow { th' = v/(rho + k*th) }
    close: when exists o in other Car: dist2(self, o) <= R^2 -> Avoid
  }
  mode Avoid {
    flow { th' = 1 [1/s] }
    clear: when forall o in other Car: dist2(self, o) >= 4*R^2 -> Spiral
  }
}

system {
  fast = Car(v = 4, rho = 2, k = 0.30, x = -2, y = -6)
  slow = Car(v = 1, rho = 1, k = 0.15, x =  4, y = y0)
}

run { until 20 [s]  tolerance 1e-8  record fast, slow every 0.05 [s] to "near_miss.csv" }
