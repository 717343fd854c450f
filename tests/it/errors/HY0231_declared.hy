// what goes into a name with a unit
param g: real [m/s^2] = 9.81 [m]
param T: real [h] = 3
let   H: real [m] = 3*T
fn fall(t: real [s]): real [m] = g*t
fn half(t: real, add: real [m] = 3 [s]): real [m] = t/2

agent Ball(h: real [m] = g) {
  state x: real [m] = 2*T, v: real [km/h] = 120, w: real [rad/s] = 3 [rpm]
  discrete top: real [m] = h
  let speed: real [m/s] = x
  flow { x' = x  v' = -0.5*v  w' = 3 [1/s]*w }
  entry { x := v  top := T }
  when x <= 0 { x := if x > 3 then v else 2  v := fall(x)*(1 [1/s]) }
  when half(v) > 0 { }
}
system { balls = Ball[3](h = 3 [s], x = 5 [m]*index, v = 2 [m/s]) }
