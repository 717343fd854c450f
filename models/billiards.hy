// billiards.hy: discs of different masses in a box: they fly straight, and bounce off the walls and each other without loss.
// Shows an interaction with one guard for each pair, and what must not change: the energy at every event, and the
// momentum of two discs that meet. Other sizes: hyc run billiards.hy -p n=30

param n:     int        = 12
param half:  real [m]   = 5                  // half the side of the box
param r:     real [m]   = 0.5                // radius of a disc
param speed: real [m/s] = 3                  // along a side, at most, at first
let   columns = ceil(sqrt(n))
let   cell    = 2*half/columns               // at first each disc is in a cell of its own

agent Disc(m: real [kg]) {
  state x: real [m] = cell*(mod(index, columns) + 0.5) - half,
        y: real [m] = cell*(floor(index/columns) + 0.5) - half
  discrete u: real [m/s] = speed*sin(2*index + 1),
           v: real [m/s] = speed*cos(3*index)
  let energy = m*(u^2 + v^2)/2
  flow { x' = u  y' = v }
  left:   when x <= r - half { u := -u }
  right:  when x >= half - r { u := -u }
  bottom: when y <= r - half { v := -v }
  top:    when y >= half - r { v := -v }
}

fn dist2(a: Disc, b: Disc) = (a.x - b.x)^2 + (a.y - b.y)^2

// what a's velocity loses along the line of centres
fn share(a: Disc, b: Disc) =
    2*b.m/(a.m + b.m)*((a.u - b.u)*(a.x - b.x) + (a.v - b.v)*(a.y - b.y))/dist2(a, b)

interaction Hit(a: Disc, b: Disc) {
  pair: when dist2(a, b) <= (2*r)^2 {
    a.u := a.u - share(a, b)*(a.x - b.x)  a.v := a.v - share(a, b)*(a.y - b.y)
    b.u := b.u - share(b, a)*(b.x - a.x)  b.v := b.v - share(b, a)*(b.y - a.y)
  }
}

system { discs = Disc[n](m = 1 + mod(index, 3)) }

run {
  until 20 [s]
  record Disc, Disc.energy every 0.05 [s] to "billiards.csv"
  events to "hits.csv"
}
