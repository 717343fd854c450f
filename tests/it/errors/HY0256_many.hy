agent Dot { state x = 0  flow { x' = 1 } }
agent Maker {
  make: every 1 { create Dot[2]()  create Dot() from csv("dots.csv") }
}
system { maker = Maker() }
