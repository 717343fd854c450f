// bouncing_ball.hy: a ball falls 1 m and bounces nineteen times in 4 s.
// Shows a reset, a guard that is on its boundary after the reset, and an invariant that only touches it.
// Run on to its limit, t = 4.0637, with --until 5: the run ends in the Zeno diagnostic, never below the floor.

param g: real [m/s^2] = 9.81
param e = 0.8                                // coefficient of restitution
param h: real [m] = 1

agent Ball {
  state x: real [m] = h, v: real [m/s] = 0
  flow { x' = v
         v' = -g }
  invariant x >= 0
  bounce: when x <= 0 { v := -e*v }
}

system { ball = Ball() }

run {
  until 4 [s]
  tolerance 1e-10
  record ball every 0.01 [s] to "bouncing_ball.csv"
  events to "bounces.csv"
}
