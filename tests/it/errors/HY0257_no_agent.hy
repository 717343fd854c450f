agent Dot { state x = 0  flow { x' = 1 }  end: when x >= 1 { destroy x  destroy none } }
system { dot = Dot() }
