// collide_and_stick.hy: two carts on springs run into each other, stick, and move on as one until their springs pull
// harder than the glue holds; then they part, and meet again. Each meeting costs energy: in the end they stay together.
// Shows flows that are coupled in one mode only, and events of two agents at one instant: each writes only itself, and
// both read the state before the event.

param width: real [m] = 0.1                  // of a cart
param hold:  real [N] = 4                    // what the glue bears

agent Cart(m: real [kg], k: real [N/m], rest: real [m], partner: Cart) {
  state x: real [m], v: real [m/s] = 0
  let spring = k*(rest - x)                  // pulls the cart to where it is at rest
  let side   = if rest < partner.rest then 1 else -1   // the partner is to the right, to the left
  let gap    = side*(partner.x - x) - width
  flow { x' = v }

  initial mode Free {
    flow { v' = spring/m }
    meet: when gap <= 0 and side*(v - partner.v) > 0 -> Joined {
      v := (m*v + partner.m*partner.v)/(m + partner.m)
    }
  }
  mode Joined {
    let pull = side*(m*partner.spring - partner.m*spring)/(m + partner.m)   // what the glue has to bear
    flow { v' = (spring + partner.spring)/(m + partner.m) }
    part: when pull >= hold -> Free
  }
}

system {
  left  = Cart(m = 1, k = 20, rest = -0.2, x = -1.2, partner = right)
  right = Cart(m = 2, k = 15, rest = 0.2,  x = 1,    partner = left)
}

run {
  until 12 [s]
  tolerance 1e-10
  record Cart every 0.01 [s] to "carts.csv"
  events to "contacts.csv"
}
