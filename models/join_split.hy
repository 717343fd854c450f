// join_split.hy: a platoon opens a gap for a guest that wants in, and closes up after a car that leaves. Shows links to
// the nearest ahead that change with a lane, so that flows are coupled to others from then on; messages between those who
// open the gap and those who come; modes.

param v0: real [km/h]  = 90
param h: real [s]      = 1.0                 // time headway
param s0: real [m]     = 5                   // from bumper to bumper at a standstill
param len: real [m]    = 4.5
param kp: real [1/s^2] = 0.3
param kv: real [1/s]   = 0.9
param wish: real [s]   = 5                   // when the guest asks
param off: real [m]    = 1000                // where one leaves

agent Car(number: int, guest: bool = false, leaves: bool = false) {
  event join(at: int)                        // a guest asks to be let in in front of this one
  event ready                                // the gap is open
  link host: Car                             // of a guest: who lets it in
  link lead = nearest o in other Car where o.lane == lane and o.x > x by o.x - x

  state x: real [m], v: real [km/h] = v0
  discrete lane: int = 1
  let gap: real [m] = if lead then lead.x - x - len else inf

  flow { x' = v }
  assert gap > 0 [m] "a collision"

  initial mode Drive {
    flow {
      v' = if lead then kp*(lead.x - x - len - s0 - h*v) + kv*(lead.v - v) else 0.5 [1/s]*(v0 - v)
    }
    yield: on join(at) when at == number -> Yield
    leave: when leaves and x >= off -> Leave { lane := 0 }
  }
  mode Yield {                               // room for another one, twice as far behind
    flow {
      v' =
          if lead then kp*(lead.x - x - 2*(len + s0 + h*v)) + kv*(lead.v - v)
          else 0.5 [1/s]*(v0 - v)
    }
    open: when gap >= len + 2*(s0 + h*v) - 1 [m] { emit ready }
    closed: when lead and lead.guest -> Drive
  }
  mode Beside {                              // a guest, on a lane of its own
    flow { v' = 0.5 [1/s]*(v0 - v) }
    ask: after wish { if host { emit join(host.number) } }
    go: on ready from host -> Align
  }
  mode Align {                               // to the middle of the gap
    let away = if host and host.lead then (host.x + host.lead.x)/2 - x else inf
    flow {
      v' = if host and host.lead then kp*((host.x + host.lead.x)/2 - x) + kv*(host.v - v) else 0
    }
    in_: when abs(away) <= 0.5 [m] -> Drive { lane := 1 }
  }
  mode Leave { flow { v' = -0.1 [1/s]*(v - v0/2) } }
}

system {
  cars = Car[5](number = index, leaves = index == 3, x = -index*(len + s0 + h*v0))
  guest = Car(number = -1, guest = true, host = cars[2], lane = 2, x = -3*(len + s0 + h*v0))
      in Beside
}

run {
  until 60 [s]
  tolerance 1e-9
  record Car.x, Car.v, Car.lane, Car.lead every 0.1 [s] to "join_split.csv"
  events to "join_split_events.csv"
}
