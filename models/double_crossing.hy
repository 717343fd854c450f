// double_crossing.hy: balls are thrown up past a light barrier: each but the last rises above it by a tenth of what the one
// before did, and is back below it sooner; the last stays a millionth of the barrier's height short of it.
// Shows two roots of a guard so close together that no step ends between them. In closed form: a ball that rises `over`
// above the bar is above it for 2*sqrt(2*over/g), in the middle of its flight.

param bar: real [m]     = 5
param g:   real [m/s^2] = 10
param n:   int          = 8                  // balls that rise above the bar: by 0.1, 0.01, ... m

agent Ball(over: real [m]) {
  state x: real [m] = 0, v: real [m/s] = sqrt(2*g*(bar + over))
  discrete seen: int = 0
  flow { x' = v  v' = -g }
  initial mode Below {
    up: when x >= bar -> Above { seen := seen + 1 }
  }
  mode Above {
    down: when x < bar -> Below
  }
}

system {
  balls = Ball[n](over = 0.1^(index + 1))
  short = Ball(over = -1e-6*bar)
}

run {
  until 1.9 [s]
  tolerance 1e-9
  record Ball every 0.01 [s] to "balls.csv"
  events to "barrier.csv"
}
