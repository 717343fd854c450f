param N = 3
agent Car(v_des: real) {
  state x = 0
  link lead: Car
  let gap = 3
  flow { x' = 1 }
  when x > 1 { v_des := 0 gap := 2 lead := none N := 4 }
}
