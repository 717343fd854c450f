param k = index
fn mine() = self.x
fn alone() = not exists o in other Car: o.x > 0
agent Car { state x = 0 flow { x' = Normal(0, 1) } }
