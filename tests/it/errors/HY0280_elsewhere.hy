agent Car { state x = 0  flow { x' = 1 } }
system { cars = Car[3]() }
run { duration 10  output to "cars.csv"  solver taylor  rtol 1e-6  atol 1e-6 }
