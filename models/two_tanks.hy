// two_tanks.hy: an upper tank empties into a lower one, which empties too; levels after Torricelli.
// Shows a flow that is not defined beyond its guard: the square root of a level, up to the instant at which it is zero.
// With c2 = 2*c1, levels 1 and 4: the upper is empty at t = 2/c1, the lower at t = (2 + exp(-1))/c1.

param c1 = 0.5                               // outflow of the upper tank at level 1
param c2 = 1

agent Tanks {
  state upper = 1, lower = 4
  invariant upper >= 0 "the upper level is below its floor"
  invariant lower >= 0 "the lower level is below its floor"
  initial mode Both {
    flow { upper' = -c1*sqrt(upper)
           lower' = c1*sqrt(upper) - c2*sqrt(lower) }
    dry: when upper <= 0 -> Lower { upper := 0 }
  }
  mode Lower {
    flow { upper' = 0
           lower' = -c2*sqrt(lower) }
    empty: when lower <= 0 -> Empty { lower := 0 }
  }
  mode Empty {
    flow { upper' = 0
           lower' = 0 }
  }
}

system { tanks = Tanks() }

run {
  until 6
  tolerance 1e-8
  record tanks every 0.01 to "two_tanks.csv"
  events to "two_tanks_events.csv"
}
