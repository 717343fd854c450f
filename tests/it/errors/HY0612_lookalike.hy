param PI = 3.14
param form = 2
fn area(tme: real) = PI*tme^form
agent Car { state Time = 0  link slef: Car  flow { Time' = area(2) }
  all: when forall Index in other Car: Index.Time >= 3 and not slef { Time := 0 } }
system { cars = Car[2]() }
