// every kind of name that can be unused
param size = 3
let twice = 2*3
fn area(r: real) = r^2
fn wide(r: real, depth: real) = r^2

agent Car(mass: real, rank: int) {
  state x = rank, y = wide(1, 2)
  link lead: Car
  let gap = x - y
  flow { x' = 1  y' = 0 }
  meet: when exists o in other Car where x >= 2: y <= 3 { x := 0 }
  all:  when forall o in other Car: y >= 3 { x := 0 }
}

interaction Touch(a: Car, b: Car) {
  let near = a.x
  hit: when a.x >= 3 { a.x := 0 }
}

system { cars = Car[3](mass = 1, rank = index) }
