param lit: bool = 3
fn area(r: real) = pi*r^2
agent Truck { }
agent Car(lead: Car) {
  discrete stopped: bool = false
  when stopped { stopped := 1 }
  when stopped == 0 { stopped := false }
  let a = area(true)
  let b = if stopped then 1 else true
}
system {
  truck = Truck()
  car = Car(lead = truck)
}
