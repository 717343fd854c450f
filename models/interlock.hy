// interlock.hy: a pump fills a tank and lets it run empty, in turn. When the power fails it stops, whatever it was doing, and
// goes on with it afterwards.
// Shows what Charon's concepts are here: agents that read each other's variables, modes with invariants and entry
// actions, a transition out of a group of modes, and a mode that is remembered. In closed form: straight lines.

param low:    real [m]   = 1
param high:   real [m]   = 3
param inflow: real [m/s] = 0.5
param outflow: real [m/s] = 0.25

agent Mains {
  initial mode On { fail: after 6.5 [s] -> Off }
  mode Off { back: after 2 [s] -> On }
}

agent Tank(pump: Pump) {
  state level: real [m] = low
  flow { level' = pump.feed }                // a discrete of another agent: the two are not coupled
}

agent Pump(tank: Tank, mains: Mains) {
  discrete feed: real [m/s] = 0, was_filling: bool = true
  trip: when mains is Off -> Stopped         // outside the modes: leaves whichever is active

  initial mode Fill {
    entry { feed := inflow  was_filling := true }
    invariant tank.level <= high "the tank overflows"
    full: when tank.level >= high -> Drain
  }
  mode Drain {
    entry { feed := -outflow  was_filling := false }
    invariant tank.level >= low "the pump runs dry"
    empty: when tank.level <= low -> Fill
  }
  mode Stopped {
    entry { feed := 0 }
    fill:  when mains is On and was_filling -> Fill
    drain: when mains is On and not was_filling -> Drain
  }
}

system {
  mains = Mains()
  tank  = Tank(pump = pump)
  pump  = Pump(tank = tank, mains = mains)
}

run {
  until 40 [s]
  record tank, pump every 0.1 [s] to "interlock.csv"
  events to "interlock_events.csv"
}
