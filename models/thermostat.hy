// thermostat.hy: a room is kept between 19 and 21 degrees above the freezing point by a heater that is on or off.
// Shows two modes with flows of their own and a hysteresis; every switching time is known in closed form.

param outside: real [K] = 278.15
param low:     real [K] = 292.15
param high:    real [K] = 294.15
param heater:  real [K] = 30                 // how far above the outside the heater would bring the room
param tau:     real [s] = 3600               // time constant of the walls

agent Room(start: real [K]) {
  state T: real [K] = start
  initial mode Off {
    flow { T' = (outside - T)/tau }
    cold: when T <= low -> On
  }
  mode On {
    flow { T' = (outside + heater - T)/tau }
    warm: when T >= high -> Off
  }
}

system { room = Room(start = 293.15) }

run { until 14400 [s]  tolerance 1e-10  record room every 60 [s] to "thermostat.csv"  events to "switches.csv" }
