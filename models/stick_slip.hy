// stick_slip.hy: a block on a spring rubs on a belt, with Coulomb friction that is smaller in motion than at rest.
// Shows a mode in which two guards stay on their boundary: while the block sticks, its speed is the belt's and so are all
// its rates; only the spring decides when it is let go. On a belt that stands still the same block swings out and stops.

param m:    real [kg]    = 1
param k:    real [N/m]   = 100
param mu_s: real         = 0.4               // friction at rest
param mu_k: real         = 0.25              // and in motion
param g:    real [m/s^2] = 9.81
let   Fs = mu_s*m*g
let   Fk = mu_k*m*g

agent Block(belt: real [m/s]) {
  state x: real [m] = 0, v: real [m/s] = belt   // x = 0: the spring is at rest
  flow { x' = v }
  let held = abs(k*x) <= Fs                  // friction at rest can bear the spring

  initial mode Stick {
    flow { v' = 0 }
    pulled: when k*x >= Fs  -> Slower
    pushed: when k*x <= -Fs -> Faster
  }
  mode Slower {                              // than the belt: friction pulls forward
    flow { v' = (Fk - k*x)/m }
    caught:   when v >= belt and held     -> Stick { v := belt }
    overtake: when v >= belt and not held -> Faster
  }
  mode Faster {                              // friction pulls back
    flow { v' = (-Fk - k*x)/m }
    joined:   when v <= belt and held     -> Stick { v := belt }
    fallback: when v <= belt and not held -> Slower
  }
}

system {
  driven = Block(belt = 0.2)                 // sticks and slips for ever
  free   = Block(belt = 0, x = 0.23)         // on the floor: loses 2 Fk/k of its amplitude in every half swing
}

run {
  until 5 [s]
  tolerance 1e-10
  record Block every 0.005 [s] to "stick_slip.csv"
  events to "stick_slip_events.csv"
}
