// highway.hy: cars enter three lanes by a Poisson process, follow, change lanes, panic, brake and leave.
// Shows agents that come and go, a link to the nearest ahead, groups of coupled flows that form and dissolve with it, a
// hierarchy of modes with group transitions and history, messages (brake lights), hazards and random draws.

param lanes: int      = 3
param road:  real [m] = 2000
param len:   real [m] = 5
param s0:    real [m] = 4                    // standstill gap
param Th:    real [s] = 1.4                  // time headway
param b_max: real [m/s^2] = 6
param arrivals: real [1/s] = 0.25            // per lane

agent Car(lane0: int, v_des: real [m/s]) {
  state    x: real [m] = 0, v: real [m/s] = v_des
  discrete lane: int = lane0
  event    braking

  link lead = nearest o in other Car where o.lane == lane and o.x > x by o.x - x
  let  gap: real [m]   = if lead then lead.x - x - len else inf
  let  dv:  real [m/s] = if lead then v - lead.v       else 0
  let  s_brake = s0 + max(dv, 0)^2/(2*0.7*b_max)
  let  s_follow = s_brake + Th*v

  flow { x' = v }
  invariant v >= -1e-6 [m/s]
  assert gap > 0 [m] "rear-end collision"
  leave: when x >= road { destroy self }     // every mode: an agent-level (group) transition

  initial mode Drive {                       // composite mode
    jam:   when gap <= s_brake -> Brake      // group transitions: preempt Cruise and Follow
    panic: rate 0.002 [1/s]    -> Brake
    light: on braking from lead when gap <= 1.5*s_follow -> Brake

    initial mode Cruise {
      flow { v' = 0.5 [1/s]*(v_des - v) }
      when gap <= s_follow -> Follow
    }
    mode Follow {                            // reads lead.x, lead.v: coupled to the car in front
      flow { v' = 0.25 [1/s^2]*(gap - s0 - Th*v) - 0.8 [1/s]*dv }
      when not lead or gap >= 1.3*s_follow -> Cruise
      pass: when lane < lanes
          and v <= 0.8*v_des
          and not exists o in other Car: o.lane == lane + 1 and abs(o.x - x) <= 30 [m] -> Cruise {
        lane := lane + 1
      }
    }
  }
  mode Brake {
    entry { emit braking }
    flow { v' = -b_max }
    after 1 [s] when gap >= s0 + s_brake and v > 0 -> Drive.history
    when v <= 0 -> Stopped { v := 0 }
  }
  mode Stopped {
    flow { v' = 0 }
    when gap >= 3*s0 -> Drive
  }
}

agent Ramp(lane: int) {                      // cars enter: a Poisson process
  enter: rate arrivals when not exists o in Car: o.lane == lane and o.x <= 40 [m] {
    create Car(lane0 = lane, v_des ~ Normal(30, 3))
  }
}

system { ramps = Ramp[lanes](lane = index + 1) }
property no_crash = always forall c in Car: c.gap > 0 [m]
run { until 600 [s]  seed 1  record Car.x, Car.v, Car.lane every 0.5 [s] to "highway_cars.csv" }
