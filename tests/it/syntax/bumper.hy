param N: int = 20
param data: string = "bumper_20.csv"         // hyc run bumper.hy -p N=50 -p data=bumper_50.csv
param R = 1
param A = 0.5
let   H = 5*ceil(sqrt(N)) - R/2              // half side less the margin

agent Car(v: real, w: real, p: real) {       // no modes: one implicit mode
  state x, y, th
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

system { cars = Car[N] from csv(data) }       // columns matched to parameters and states by name; Car[] takes every row
run { until 20  tolerance 1e-6  events to "events.csv" }
