agent A { event hit  link next: A  state x = 0  flow { x' = 1 }  when x >= 1 { emit next.hit  emit hit } }
