// flock.hy: birds turn to each other's velocity, the nearer the more, until all fly alike (Cucker & Smale 2007).
// Shows a sum in a flow, which couples its owner with the whole set, and quantifiers that find when the flock has formed.

param n:    int        = 20
param K:    real [1/s] = 2                   // how strongly
param L:    real [m]   = 10                  // how far
param same: real [m/s] = 0.1                 // velocities so near are alike

fn pull(d2: real) = 1/sqrt(1 + d2/L^2)

agent Bird {
  state x: real [m] ~ Uniform(-20, 20), y: real [m] ~ Uniform(-20, 20)
  state u: real [m/s] ~ Normal(5, 2), v: real [m/s] ~ Normal(0, 2)

  flow {
    x' = u
    y' = v
    u' = K/n*(sum o in other Bird: (o.u - u)*pull((o.x - x)^2 + (o.y - y)^2))
    v' = K/n*(sum o in other Bird: (o.v - v)*pull((o.x - x)^2 + (o.y - y)^2))
  }

  initial mode Alone {
    join: when forall o in other Bird: hypot(o.u - u, o.v - v) <= same -> Flock
  }
  mode Flock {}
}

system { birds = Bird[n]() }
run { until 6 [s]  seed 7  record Bird.x, Bird.y, Bird.u, Bird.v every 0.1 [s] to "flock.csv" }
