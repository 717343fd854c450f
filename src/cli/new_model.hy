// NAME.hy: robots cross a room, turn back at its walls, and rest for a while when two of them meet.
// Made by `hyc new`: change what you like, and run it with `hyc run NAME.hy`.

// Parameters can be given another value when the model is run: hyc run NAME.hy -p n=20
param n:     int      = 6                    // how many robots
param side:  real [m] = 10                   // of the room
param near:  real [m] = 1                    // two robots meet when they are so near to each other
param pause: real [s] = 2                    // how long they rest then

// Each robot is an agent of this type. What stands in brackets is given to it in `system`.
agent Robot(speed: real [m/s]) {
  // States flow; `~` draws their first values at random, other ones for another `--seed`.
  state x: real [m] ~ Uniform(1, side - 1),
        y: real [m] ~ Uniform(1, side - 1),
        th ~ Uniform(0, 2*pi)                // where it looks, as an angle

  // A mode says how states flow while it is active. A robot starts in the initial one.
  initial mode Go {
    flow { x' = speed*cos(th)
           y' = speed*sin(th)
           th' = 0 }
    // A transition fires at the very time at which its condition becomes true, and resets what stands in braces.
    left:   when x <= 0    { th := pi - th }
    right:  when x >= side { th := pi - th }
    bottom: when y <= 0    { th := -th }
    top:    when y >= side { th := -th }
  }
  mode Rest {
    flow { x' = 0  y' = 0  th' = 0 }
    rested: after pause -> Go                // with `->` a transition changes the mode
  }
}

// What happens between two agents: here each turns away from the other, and both rest.
interaction Meet(a: Robot, b: Robot) {
  pair: when (a.x - b.x)^2 + (a.y - b.y)^2 <= near^2 {
    a.th := atan2(a.y - b.y, a.x - b.x)
    b.th := atan2(b.y - a.y, b.x - a.x)
    a -> Rest
    b -> Rest
  }
}

system {
  robots = Robot[n](speed = 1 + 0.2*index)   // the first is the slowest
}

run { until 60 [s]  record robots every 0.1 [s] to "NAME.csv"  events to "NAME_events.csv" }
