// swarm.hy: drones in space, each circling on its own level of height; two that come near each other exchange their velocities.
// Shows six states an agent, spheres as guards of pairs, and what must not change: the sum of the energies.
// Other sizes: hyc run swarm.hy -p n=1000

param n:    int      = 27
param cell: real [m] = 12                    // at first each drone is in a cell of its own
param near: real [m] = 3                     // as near as two may come
param speed: real [m/s] = 5                  // along a side, at most, at first
let   side = ceil(cbrt(n))

agent Drone {
  discrete turn:  real [1/s] = 0.3 + 0.1*mod(3*index, 7),   // how fast it circles
           rise:  real [1/s] = 0.3 + 0.1*mod(5*index, 8),   // and swings about its level
           level: real [m]   = cell*floor(index/side^2)
  state x: real [m] = cell*mod(index, side) + 0.1*mod(7*index, 11),
        y: real [m] = cell*mod(floor(index/side), side) + 0.1*mod(5*index, 13),
        z: real [m] = cell*floor(index/side^2)
  state vx: real [m/s] = speed*sin(2*index + 1),
        vy: real [m/s] = speed*cos(3*index),
        vz: real [m/s] = 0.5*speed*sin(5*index)
  flow {
    x'  = vx        y'  = vy       z'  = vz
    vx' = -turn*vy  vy' = turn*vx  vz' = -rise^2*(z - level)
  }
}

interaction Meet(a: Drone, b: Drone) {
  pair: when (a.x - b.x)^2 + (a.y - b.y)^2 + (a.z - b.z)^2 <= near^2 {
    a.vx := b.vx  a.vy := b.vy  a.vz := b.vz
    b.vx := a.vx  b.vy := a.vy  b.vz := a.vz
  }
}

system { drones = Drone[n]() }

run {
  until 20 [s]
  record Drone.x, Drone.y, Drone.z every 0.05 [s] to "swarm.csv"
}
