// bumper_random.hy: the bumper arena with cars that the seed draws: hyc compare bumper_random.hy -p N=2:20 --seeds 10
// Shows random initial values, and a `spread` of time scales: the ratio of the fastest to the slowest weaving.
// After J. M. Esposito and V. Kumar, 2004, section 8.

param N: int = 10
param R = 1
param A = 0.5
param spread = 40
let   m = ceil(sqrt(N))                      // cells on a side, 10 by 10 each, one car in a cell
let   H = 5*m - R/2                          // half side less the margin

agent Car {
  discrete p ~ Uniform(0, 2*pi), u ~ Uniform(0, 1), q ~ Uniform(-0.5, 0.5)
  discrete v = 0.2*10^u, w = sqrt(10)*spread^q
  discrete dx ~ Uniform(-3, 3), dy ~ Uniform(-3, 3)
  state x = 10*mod(index, m) + 5 - 5*m + dx, y = 10*floor(index/m) + 5 - 5*m + dy
  state th ~ Uniform(0, 2*pi)
  flow { x'  = v*cos(th)
         y'  = v*sin(th)
         th' = A*w*sin(w*time + p) }
  left:   when x <= -H { th := atan2(-y, -x) }
  right:  when x >=  H { th := atan2(-y, -x) }
  bottom: when y <= -H { th := atan2(-y, -x) }
  top:    when y >=  H { th := atan2(-y, -x) }
}

interaction Bump(a: Car, b: Car) {
  pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= R^2 {
    a.th := atan2(a.y - b.y, a.x - b.x)
    b.th := atan2(b.y - a.y, b.x - a.x)
  }
}

system { cars = Car[N] }

run { until 20  tolerance 1e-5 }
