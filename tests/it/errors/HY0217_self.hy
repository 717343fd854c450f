agent A { state x = 0  flow { x' = 1 } }
property p = always forall a in A: a.x <= self.x
run { stop when self is Go }
