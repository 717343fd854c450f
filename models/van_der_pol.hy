// van_der_pol.hy: an oscillator whose damping changes its sign: it creeps for hundreds of seconds, then jumps in milliseconds.
// Shows a flow that is stiff on its way and is not where it jumps: the automatic choice changes the method there and back.

param mu = 1000

agent Oscillator {
  state x = 2, y = 0
  discrete jumps: int = 0
  flow { x' = y
         y' = mu*(1 - x^2)*y - x }
  near:  when x <= 1.5 {}                    // most of the way is over
  falls: when x <= 0 { jumps := jumps + 1 }
  rises: when rising(x >= 1) { jumps := jumps + 1 }
  flash: when y >= 100 {}                    // for a millisecond of a jump
}

system { oscillator = Oscillator() }

run {
  until 4000  tolerance 1e-8
  record oscillator every 1 to "van_der_pol.csv"  events to "van_der_pol_events.csv"
}
