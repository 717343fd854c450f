agent A { state x = 0  flow { x' = sum o in other A: o.x }  after 1 { create A() } }
system { a = A() }
run { until 2 }
