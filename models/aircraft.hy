// aircraft.hy: two aircraft on crossing courses fly around each other and come back to their courses.
// The manoeuvre: when they come within `alert` of each other, both turn right by 90 degrees, fly half a circle to the
// left, and turn right again. Shows resets of a heading, a timed mode, guards over the other aircraft, and an assert.
// After C. Tomlin, G. Pappas and S. Sastry, 1998, who turn the heading at once too.

param v:     real [m/s] = 250
param r:     real [km]  = 10                 // radius of the half circles
param alert: real [km]  = 20
param safe:  real [km]  = 9.26               // 5 nautical miles
param angle: real [deg] = 120                // between the courses; 180 is head-on
param far:   real [km]  = 60                 // from where the courses cross, at first
let   omega = v/r

fn dist2(a: Aircraft, b: Aircraft) = (a.x - b.x)^2 + (a.y - b.y)^2

// half the rate of dist2 while both cruise: negative if they come nearer
fn closing(a: Aircraft, b: Aircraft) =
    (a.x - b.x)*v*(cos(a.phi) - cos(b.phi)) + (a.y - b.y)*v*(sin(a.phi) - sin(b.phi))

agent Aircraft(course: real [deg]) {
  state x: real [km] = -far*cos(course),
        y: real [km] = -far*sin(course),
        phi: real [deg] = course
  flow { x' = v*cos(phi)
         y' = v*sin(phi) }
  assert not exists o in other Aircraft: dist2(self, o) < safe^2 "two aircraft are too close"

  initial mode Cruise {
    flow { phi' = 0 }
    conflict: when exists o in other Aircraft: dist2(self, o) <= alert^2 and closing(self, o) < 0
        -> Circle { phi := phi - pi/2 }
  }
  mode Circle {
    flow { phi' = omega }
    done: after pi/omega -> Cruise { phi := phi - pi/2 }
  }
}

system {
  first  = Aircraft(course = 0)
  second = Aircraft(course = angle)
}

run {
  until 10 [min]
  tolerance 1e-10
  record Aircraft every 1 [s] to "aircraft.csv"
  events to "aircraft_events.csv"
}
