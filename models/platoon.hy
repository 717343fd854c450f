// platoon.hy: cars follow each other at a time headway; the first brakes and speeds up again, and what it does runs back
// through the platoon. Shows flows that are coupled along a chain of links, and a result of control: with a headway so
// long that kp*Th^2 + 2*kv*Th >= 2 the disturbance becomes smaller from car to car (string stability); with -p Th=0.6
// it grows.

param n: int           = 10                  // followers
param v0: real [km/h]  = 90
param Th: real [s]     = 1.4                 // time headway
param s0: real [m]     = 7                   // from nose to nose at a standstill
param kp: real [1/s^2] = 0.3
param kv: real [1/s]   = 0.6

agent Car {
  link lead: Car                             // the car in front
  state x: real [m], v: real [km/h] = v0
  let error = if lead then lead.x - x - s0 - Th*v else 0
  let dv    = if lead then lead.v - v else 0
  flow { x' = v }
  assert not lead or lead.x > x "a collision"

  initial mode Follow {
    flow { v' = kp*error + kv*dv }
  }

  mode Cruise {                              // the first car goes through these
    flow { v' = 0 }
    brake: after 5 [s] -> Brake
  }
  mode Brake {
    flow { v' = -2 [m/s^2] }
    push: after 4 [s] -> Push
  }
  mode Push {
    flow { v' = 1 [m/s^2] }
    settle: after 8 [s] -> Steady
  }
  mode Steady {
    flow { v' = 0 }
  }
}

system {
  first = Car(x = 0) in Cruise
  cars = Car[n](x = -(index + 1)*(s0 + Th*v0), lead = if index == 0 then first else cars[index - 1])
}

run {
  until 90 [s]
  tolerance 1e-9
  record Car every 0.1 [s] to "platoon.csv"
  events to "platoon_events.csv"
}
