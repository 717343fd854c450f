// metro.hy: a train runs from station to station, and opens and closes its doors at each.
// Shows regions, modes that are active beside each other: each has flows of its own, and each waits for what the other does by
// `self is Region.Mode`. Run has modes inside, so that braking begins from whichever is active. In closed form: areas under the speed.

param distance: real [m]     = 600           // from station to station
param v_max:    real [m/s]   = 20
param a:        real [m/s^2] = 1
param b:        real [m/s^2] = 1.25          // braking
param dwell:    real [s]     = 12            // doors open

agent Train {
  state x: real [m] = 0, v: real [m/s] = 0, open = 0
  discrete next_stop: real [m] = distance
  let stopping = v^2/(2*b)
  flow { x' = v }
  assert open <= 0 or v <= 0 "the doors are open on the way"

  region Motion {
    initial mode Run {
      brake: when next_stop - x <= stopping -> Brake
      initial mode Gain { flow { v' = a }  top: when v >= v_max -> Roll }
      mode Roll { flow { v' = 0 } }
    }
    mode Brake {
      flow { v' = -b }
      halt: when v <= 0 -> Halt { v := 0  next_stop := next_stop + distance }
    }
    mode Halt { flow { v' = 0 }  depart: when rising(self is Doors.Closed) -> Run }
  }
  region Doors {
    initial mode Closed { flow { open' = 0 }  arrive: when rising(self is Motion.Halt) -> Opening }
    mode Opening { flow { open' = 0.5 [1/s] }  wide: when open >= 1 -> Wide }
    mode Wide    { flow { open' = 0 }  close: after dwell -> Closing }
    mode Closing { flow { open' = -0.25 [1/s] }  shut: when open <= 0 -> Closed { open := 0 } }
  }
}

system { train = Train() }
run { until 300 [s]  record train every 0.5 [s] to "metro.csv"  events to "metro_events.csv" }
