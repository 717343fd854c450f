// convoy.hy: six cars in one lane behind a lorry that brakes now and then; the wave runs through all of them.
// Shows modes in modes: `jam` leaves Drive from Cruise and from Follow alike; who has braked long enough goes on with what it
// did before, `Drive.history`. The flow of x and the claims stand outside of all modes. `-p brake=8`: the lorry
// stops, and the assert tells that looking at the difference of speeds alone is not enough (exit code 4).

param len:   real [m]     = 5                // of a car
param s0:    real [m]     = 4                // standstill gap
param Th:    real [s]     = 1.0              // time headway
param b_max: real [m/s^2] = 6
param brake: real [s]     = 3                // how long the lorry brakes; with 8 it stops

agent Lorry(v0: real [m/s], pause: real [s]) {
  state x: real [m], v: real [m/s] = v0
  flow { x' = v }
  initial mode Roll { flow { v' = 0 }  slow: after 12 [s] -> Halt }
  mode Halt {
    again: after brake when v > 0 -> Gain    // it did not have to stop
    initial mode Slow { flow { v' = -4 [m/s^2] }  still: when v <= 0 -> Wait { v := 0 } }
    mode Wait { flow { v' = 0 }  go: after pause -> Gain }
  }
  mode Gain { flow { v' = 1 [m/s^2] }  steady: when v >= v0 -> Roll }
}

agent Car(v_des: real [m/s], lorry: Lorry) {
  state x: real [m], v: real [m/s] = v_des
  link  lead: Car                            // none for the first, which follows the lorry
  let   gap: real [m]   = (if lead then lead.x else lorry.x) - x - len
  let   dv:  real [m/s] = v - (if lead then lead.v else lorry.v)
  let   s_brake  = s0 + max(dv, 0)^2/(2*0.7*b_max)
  let   s_follow = s_brake + Th*v

  flow { x' = v }
  invariant v >= -1e-6 [m/s]
  assert gap > 0 [m] "rear-end collision"

  initial mode Drive {
    jam: when gap <= s_brake -> Brake        // a group transition: preempts Cruise and Follow
    initial mode Cruise {
      flow { v' = 0.3 [1/s]*(v_des - v) }
      near_: when gap <= s_follow -> Follow
    }
    mode Follow {                            // reads the one in front: coupled to it
      flow { v' = 0.1 [1/s^2]*(gap - s0 - Th*v) - 0.4 [1/s]*dv }
      free: when gap >= 1.3*s_follow -> Cruise
    }
  }
  mode Brake {
    flow { v' = -b_max }
    ease:  after 1 [s] when gap >= s0 + s_brake and v > 0 -> Drive.history
    still: when v <= 0 -> Stopped { v := 0 }
  }
  mode Stopped {
    flow { v' = 0 }
    start: when gap >= 3*s0 -> Drive
  }
}

system {
  lorry = Lorry(v0 = 20, pause = 8, x = 60)
  cars  = Car[6](
    v_des = 30 - index,
    x = -60*index,
    lorry = lorry,
    lead = if index > 0 then cars[index - 1] else none
  )
}

run { until 90 [s]  record cars every 0.5 [s] to "convoy.csv"  events to "convoy_events.csv" }
