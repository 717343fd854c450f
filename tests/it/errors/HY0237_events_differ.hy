agent Car { event hit(v: real [m/s])  after 1 [s] { emit hit(3) } }
agent Bus { event hit(v: real [m])  after 1 [s] { emit hit(3) } }
agent Log(car: Car) { discrete n: int = 0  on hit { n := n + 1 }  on hit from car { n := n + 1 } }
