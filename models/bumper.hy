// bumper.hy: cars that weave about a square arena, turn back at its walls and bump away from each other.
// Shows agents from a data file, walls as guards of one agent, and an interaction with one guard for each pair.
// After J. M. Esposito and V. Kumar, 2004, section 8. Other sizes: hyc run bumper.hy -p N=50 -p data=bumper_50.csv

param N: int = 20
param data: string = "bumper_20.csv"
param R: real [m] = 1
param A = 0.5
let   H = 5 [m]*ceil(sqrt(N)) - R/2          // half side less the margin

agent Car(v: real [m/s], w: real [rad/s], p: real [rad]) {   // no modes: one implicit mode
  state x: real [m], y: real [m], th: real [rad]
  flow { x'  = v*cos(th)
         y'  = v*sin(th)
         th' = A*w*sin(w*time + p) }
  left:   when x <= -H { th := atan2(-y, -x) }
  right:  when x >=  H { th := atan2(-y, -x) }
  bottom: when y <= -H { th := atan2(-y, -x) }
  top:    when y >=  H { th := atan2(-y, -x) }
}

interaction Bump(a: Car, b: Car) {           // one guard per unordered pair
  pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= R^2 {
    a.th := atan2(a.y - b.y, a.x - b.x)      // both right-hand sides read the state just before the event
    b.th := atan2(b.y - a.y, b.x - a.x)
  }
}

system { cars = Car[N] from csv(data) }

run { until 20  tolerance 1e-6  events to "events.csv" }
