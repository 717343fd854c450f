// thermostat.hy: a room is kept between 19 and 21 degrees by a heater that is on or off; time is in hours.
// Shows two modes with flows of their own and a hysteresis. In closed form: off at first, it cools in log(10/9);
// then the heater is on for log(21/19) and off for log(11/9), in turn.

param outside = 10
param heater  = 30                           // how far above the outside the heater would bring the room
param low     = 19
param high    = 21
param tau     = 1                            // time constant of the walls

agent Room {
  state T = 20
  initial mode Off {
    flow { T' = (outside - T)/tau }
    cold: when T <= low -> On
  }
  mode On {
    flow { T' = (outside + heater - T)/tau }
    warm: when T >= high -> Off
  }
}

system { room = Room() }

run {
  until 3
  tolerance 1e-10
  record room every 0.01 to "thermostat.csv"
  events to "switches.csv"
}
