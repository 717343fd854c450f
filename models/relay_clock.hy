// relay_clock.hy: a capacitor is charged until a relay with hysteresis switches it to discharge, and so on: a clock.
// Shows ten thousand events without drift: in closed form the relay switches every tau*log((1 + h)/(1 - h)), here 1 s.

param tau: real [s] = 0.5
param h = tanh(1)                            // the relay switches at h and at -h of its full voltage

agent Relay {
  state u = 0                                // voltage as a share of the full one
  discrete ticks: int = 0
  initial mode Up {
    flow { u' = (1 - u)/tau }
    high: when u >= h -> Down { ticks := ticks + 1 }
  }
  mode Down {
    flow { u' = (-1 - u)/tau }
    low: when u <= -h -> Up { ticks := ticks + 1 }
  }
}

system { clock = Relay() }

run {
  until 10000 [s]
  tolerance 1e-12
  record clock every 10 [s] to "relay_clock.csv"
  events to "ticks.csv"
}
