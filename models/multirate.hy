// multirate.hy: a fast oscillator follows a slow one, fifty times slower. Once it reads it continuously, from the dense output
// of a leader that does not read it. Once it samples it every `hold` and holds the sample. Each keeps its own clock.
// Shows what a flow that reads another agent costs, and what holding costs: an error of the size of `hold`.
// In closed form: cosines of both frequencies; between two samples a cosine about the sample.

param w:    real [rad/s] = 50                // of the fast one; the slow one has 1 rad/s
param hold: real [s]     = 0.1

agent Slow {
  state x = 1, v: real [1/s] = 0
  flow { x' = v  v' = -(1 [rad/s])^2*x }
}

agent Coupled(slow: Slow) {                  // reads slow.x: a follower
  state y = 0, v: real [1/s] = 0
  flow { y' = v  v' = w^2*(slow.x - y) }
}

agent Held(slow: Slow) {                     // reads slow.x at its samples only
  state y = 0, v: real [1/s] = 0
  discrete x: real = 1
  flow { y' = v  v' = w^2*(x - y) }
  sample: every hold { x := slow.x }
}

system {
  one_clock  = Coupled(slow = led)
  led        = Slow()
  own_clocks = Held(slow = alone)
  alone      = Slow()
}

run { until 6 [s]  tolerance 1e-8  record Slow, Coupled, Held every 0.01 [s] to "multirate.csv" }
