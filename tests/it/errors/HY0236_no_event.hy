agent Car { event brake  state x = 0  flow { x' = 1 }  when x >= 1 { emit braek }  on hom { x := 0 } }
agent Light(car: Car) {
  discrete lit: bool = false, n: int = 0
  on brakes { lit := true }
  on lit from car { n := n + 1 }
  on brake from n { lit := false }
}
