// highway_static.hy: 66 cars in three lanes cruise, follow, brake and stop; the first of each lane stops for a while.
// Shows links, flows that are coupled to the car in front, and groups that form and dissolve as modes change:
// a jam runs backwards through each lane, and nobody hits anybody. Nobody enters or leaves, as in highway.hy.

param lanes: int      = 3
param len:   real [m] = 5                    // of a car
param s0:    real [m] = 4                    // standstill gap
param Th:    real [s] = 1.4                  // time headway
param b_max: real [m/s^2] = 6
param site:  real [m] = 1500                 // where the first car of a lane stops
param pause: real [s] = 6                    // for how long

agent Car(lane: int, v_des: real [m/s]) {
  state    x: real [m], v: real [m/s]
  discrete stopped: bool = false

  link lead: Car                             // the car in front, if there is one
  let  gap: real [m]   = if lead then lead.x - x - len else inf
  let  dv:  real [m/s] = if lead then v - lead.v else 0
  let  s_brake = s0 + max(dv, 0)^2/(2*0.7*b_max)
  let  s_follow = s_brake + Th*v

  flow { x' = v }
  invariant v >= -1e-6 [m/s]
  assert gap > 0 [m] "rear-end collision"

  initial mode Cruise {
    flow { v' = 0.3 [1/s]*(v_des - v) }
    halt:   when not lead and not stopped and x >= site -> Brake { stopped := true }
    jam:    when gap <= s_brake -> Brake
    follow: when gap <= s_follow -> Follow
  }
  mode Follow {                              // reads lead.x, lead.v: coupled to the car in front
    flow { v' = 0.15 [1/s^2]*(gap - s0 - Th*v) - 0.6 [1/s]*dv }
    panic: when gap <= s_brake -> Brake
    free:  when gap >= 1.3*s_follow -> Cruise
  }
  mode Brake {
    flow { v' = -b_max }
    ease:  after 1 [s] when lead and gap >= s0 + s_brake and v > 0 -> Follow
    still: when v <= 0 -> Stopped { v := 0 }
  }
  mode Stopped {
    flow { v' = 0 }
    start:  when lead and gap >= 3*s0 -> Cruise
    resume: after pause when not lead -> Cruise
  }
}

system {                                     // rows of the file: front to back, one car of each lane after the other
  cars = Car[](lead = if index >= lanes then cars[index - lanes] else none)
      from csv("highway_static.csv")
}

run {
  until 90 [s]
  record cars every 0.5 [s] to "highway_static_cars.csv"
  events to "highway_static_events.csv"
}
