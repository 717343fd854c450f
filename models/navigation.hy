// navigation.hy: robots cross a map of square cells with a wind in each; a robot's velocity goes after the wind of its
// cell: x' = v, v' = A (v - wind). They start on the left; one cell is their target, one is forbidden.
// Shows a map from a data file, a guard that looks for the cell which a robot comes into, and a transition into its own
// mode: on the edge of two cells all guards are armed afresh, and the one behind is held. After A. Fehnker and
// F. Ivancic, 2004.

param n:    int        = 8                   // robots
param side: real [m]   = 1                   // of a cell
param wind: real [m/s] = 1
param a:    real [1/s] = -1.2                // A = [a, b; b, a]
param b:    real [1/s] = 0.1

agent Cell(column: int, row: int, heading: real [deg], kind: int) {}    // heading from north; kind 1: target, 2: forbidden

fn inside(r: Robot, c: Cell) =
    r.x >= c.column*side
    and r.x <= (c.column + 1)*side
    and r.y >= c.row*side
    and r.y <= (c.row + 1)*side

agent Robot {
  state    x: real [m], y: real [m], u: real [m/s], v: real [m/s]
  discrete column: int = -1, row: int = -1,  // its cell; none at first
           kind: int = 0, heading: real [deg] = 0
  let du = u - wind*sin(heading)
  let dv = v - wind*cos(heading)
  assert kind != 2 "a robot is in the forbidden cell"

  initial mode Fly {
    flow { x' = u  y' = v
           u' = a*du + b*dv
           v' = b*du + a*dv }
    cross: when exists c in Cell where c.column != column or c.row != row: inside(self, c) -> Fly {
      column := c.column  row := c.row  heading := c.heading  kind := c.kind
    }
    arrive: when kind == 1 -> Rest { u := 0  v := 0 }
  }
  mode Rest {
    flow { x' = 0  y' = 0  u' = 0  v' = 0 }
  }
}

system {
  cells  = Cell[] from csv("navigation_map.csv")
  robots = Robot[n](
    x = 0.5 [m],
    y = (index + 0.5)*3.6 [m]/n,
    u = 0.3 [m/s]*(mod(index, 3) - 1),
    v = 0.2 [m/s]
  )
}

run {
  until 8 [s]
  tolerance 1e-10
  record Robot every 0.05 [s] to "navigation.csv"
  events to "cells.csv"
}
