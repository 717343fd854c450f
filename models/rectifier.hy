// rectifier.hy: a bridge of four ideal diodes charges a capacitor, which a resistor discharges; 50 Hz, 12 V.
// Shows guards that are each other's opposite: a diode opens exactly where it has closed, on the boundary `e == v`,
// and the direction of the flow decides. While a pair conducts, v is a sine and a decay; while none does, a decay.

param E:  real [V]   = 12                    // amplitude of the source
param f:  real [Hz]  = 50
param Rs: real [Ohm] = 2                     // of the source and the diodes
param C:  real [mF]  = 1
param R:  real [Ohm] = 100                   // the load
let   w = 2*pi*f

agent Bridge {
  state v: real [V] = 0                      // across the capacitor and the load
  let e = E*sin(w*time)                      // the source

  initial mode Blocked {
    flow { v' = -v/(R*C) }
    rise: when e >= v -> Positive
    fall: when -e >= v -> Negative
  }
  mode Positive {                            // one pair of diodes conducts
    let i = (e - v)/Rs
    flow { v' = (i - v/R)/C }
    invariant i >= -1e-9 [A] "a diode conducts one way only"
    off_p: when i <= 0 -> Blocked
  }
  mode Negative {                            // and the other
    let i = (-e - v)/Rs
    flow { v' = (i - v/R)/C }
    invariant i >= -1e-9 [A] "a diode conducts one way only"
    off_n: when i <= 0 -> Blocked
  }
}

system { bridge = Bridge() }

run {
  until 100 [ms]
  tolerance 1e-10
  record bridge.v, bridge.e every 0.1 [ms] to "rectifier.csv"
  events to "diodes.csv"
}
