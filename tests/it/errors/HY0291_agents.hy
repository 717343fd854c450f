agent Car { }
system { cars = Car[1000000000000] vans = Car[10000000] more = Car[1] }
