param xs = [1, 2]
agent Car(v: real) {
  state x ~ Normal(0, 1), y = 0
  event braking
  link lead: Car = nearest o in other Car by o.x - x
  let crowd = count o in other Car: o.x > x
  let one = if lead then lead else self
  flow { x' = 1 y' = if exists o in other Car: o.x > x then 1 else 0 }
  initial mode Go {
    initial mode Fast { }
    rate 0.1 -> Go
    on braking -> Go.history
    when x > 1 { emit braking x ~ Normal(0, 1) }
    when exists o in cars: o.x > 1 -> Go
  }
}
interaction Three(a: Car, b: Car, c: Car) { when a.x > b.x { a.x := 0 } }
interaction Late(a: Car, b: Car) { after 1 { a.x := 0 } every 1 { b.x := 0 } }
system { cars = Car[2](v ~ Normal(0, 1)) }
run { stop when time > 3 algorithm 3 }
