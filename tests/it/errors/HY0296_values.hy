agent Car(a: real, b: real, c: real, d: real, e: real, f: real, g: real, h: real, i: real, j: real, k: real, l: real) {
  state x = 0, y = 0, z = 0, u = 0, v = 0, w = 0, p = 0, q = 0, r = 0
  flow { x' = 1 y' = 1 z' = 1 u' = 1 v' = 1 w' = 1 p' = 1 q' = 1 r' = 1 }
}
system { cars = Car[9999999](a = 1, b = 1, c = 1, d = 1, e = 1, f = 1, g = 1, h = 1, i = 1, j = 1, k = 1, l = 1) }
