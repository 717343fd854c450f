// two_cars.hy : after Esposito & Kumar 2004, section 6 (with these numbers the cars meet at t = 6.59)
param R: real [m] = 1.0                      // avoidance range

fn dist2(a: Car, b: Car) = (a.x - b.x)^2 + (a.y - b.y)^2

agent Car(v: real [m/s], rho: real [m], k: real [m]) {
  state x: real [m], y: real [m], th = 0
  flow { x' = v*cos(th)                      // holds in every mode
         y' = v*sin(th) }
  initial mode Spiral {                      // state feedback: the turn radius grows with the heading
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
  slow = Car(v = 1, rho = 1, k = 0.15, x =  4, y = -2)
}
run { until 30 [s]  tolerance 1e-8  record fast, slow every 0.05 [s] to "two_cars.csv" }
