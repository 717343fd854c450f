agent C { state x: real [mm] = 1, y = 1  flow { x' = 1 [m/s]  y' = 1 } }
agent A { state x: real [km] = 1, y: real [m] = 1, w: real [J] = 1  discrete z: bool = true  flow { x' = 1 [m/s]  y' = 1 [m/s]  w' = 1 [W] }  let late: real [min] = time }
agent B(y: real [s]) { state x: real [m] = 1, w: real [N*m] = 1  discrete z: real [km] = 1  flow { x' = 1 [m/s]  w' = 1 [W] }  let late = time }
system { a = A()  b = B(y = 1)  c = C[2]() }
run {
  until 1
  record a, c[0], B.y, b every 1 to "both.csv"
  record a.late, B.late every 1 to "late.csv"
  record c[1].y, A.y, B.y every 1 to "last.csv"
  record A.x, A.y, a.w, B.w, a.z, b.z, c[1].y every 1 to "fine.csv"
}
