// sector.hy: a sector of airspace. Aircraft enter at its gates, follow whoever is ahead of them on the same airway at a
// safe distance, and leave at the other side.
// Shows agents that are created and destroyed, draws for each of them, a link to the nearest kept up to date, flows that
// are coupled while they follow, and a count over whoever is there.

param side:  real [km] = 150                 // length of an airway within the sector
param near:  real [km] = 15                  // from here on an aircraft adapts to the one ahead
param safe:  real [km] = 9.26                // 5 nautical miles
param pause: real [s]  = 100                 // between two aircraft at one gate

agent Aircraft(way: int, cruise: real [m/s]) {
  state s: real [km] = 0, v: real [m/s] = cruise
  link ahead = nearest o in other Aircraft where o.way == way and o.s > s by o.s - s
  let distance: real [km] = if ahead then ahead.s - s else inf
  flow { s' = v }
  assert distance > safe "two aircraft are too close"
  leave: when s >= side { destroy self }

  initial mode Cruise {
    flow { v' = 0.01 [1/s]*(cruise - v) }
    close: when distance <= near -> Follow
  }
  mode Follow {                              // at 12 km as fast as the one ahead
    flow {
      v' = if ahead then 0.01 [1/s]*(ahead.v - v) + 4e-5 [1/s^2]*(distance - 12 [km]) else 0 [m/s^2]
    }
    free: when not ahead or distance >= 1.2*near -> Cruise
  }
}

agent Gate(way: int) {
  discrete sent: int = 0
  enter: every pause when not exists o in Aircraft: o.way == way and o.s <= near {
    sent := sent + 1
    create Aircraft(way = way, cruise ~ Uniform(200, 250))
  }
}

agent Tower {
  discrete most: int = 0                     // at a time
  busy: when (count o in Aircraft) > most { most := count o in Aircraft }
}

system {
  gates = Gate[4](way = index)
  tower = Tower()
}

run { until 1 [h]  seed 3  tolerance 1e-9
      record Aircraft.s, Aircraft.v, Aircraft.ahead every 10 [s] to "sector.csv"
      events to "sector_events.csv" }
