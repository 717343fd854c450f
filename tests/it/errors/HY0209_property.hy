agent Car { state x = 0  flow { x' = 1 } }
system { car = Car[2]()  cars = Car[3]() }
property slow = always car.x < 3
run { until 1  stop when cars[0].x > 0.5 }
