// epidemic.hy: people walk about a square; who is ill infects whom it comes near, is ill for a while, and then immune.
// Shows an interaction that is not the same for both, one guard for each ordered pair: only an ill `a` infects a healthy
// `b`; changes of mode that are made by another agent; and a count over all of them, which ends the run.

param n:       int        = 60
param side:    real [m]   = 60
param pace:    real [m/s] = 1
param reach:   real [m]   = 3                // who is so near catches it
param ill_for: real [s]   = 30
param seeds:   int        = 2                // who are ill at first
let   columns = ceil(sqrt(n))

agent Person(k: int) {
  state x: real [m] = side*(mod(k, columns) + 0.5)/columns,
        y: real [m] = side*(floor(k/columns) + 0.5)/columns
  discrete u: real [m/s] = pace*cos(2.4*k^2),  // in all directions
           v: real [m/s] = pace*sin(2.4*k^2),
           victims: int = 0
  flow { x' = u  y' = v }
  left:   when x <= 0    { u := -u }
  right:  when x >= side { u := -u }
  bottom: when y <= 0    { v := -v }
  top:    when y >= side { v := -v }

  initial mode Healthy {}
  mode Ill {
    recover: after ill_for -> Immune
  }
  mode Immune {}
}

interaction Meet(a: Person, b: Person) {
  infect: when a is Ill and b is Healthy and (a.x - b.x)^2 + (a.y - b.y)^2 <= reach^2 {
    a.victims := a.victims + 1
    b -> Ill
  }
}

agent Office {                               // counts the ill, and closes when there are none
  let ill = count p in Person: p is Ill
  over: when ill == 0 { stop "nobody is ill" }
}

system {
  office = Office()
  first  = Person[seeds](k = index) in Ill
  others = Person[n - seeds](k = seeds + index)
}

run {
  until 5 [min]
  record Person, office.ill every 0.5 [s] to "epidemic.csv"
  events to "epidemic_events.csv"
}
