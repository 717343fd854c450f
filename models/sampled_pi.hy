// sampled_pi.hy: a digital PI controller samples a first-order plant every 10 ms and holds its output in between;
// at t = 2 a load sets in.
// Shows `every`, discrete variables, and that all right-hand sides of an action read the state before it.

param r  = 1                                 // set point
param kp = 2
param ki: real [1/s] = 10
let   Ts = 10 [ms]

agent Loop {
  state    y = 0                             // the plant
  discrete u = 0,                            // what the controller holds
           i = 0                             // its integral
  let error = r - y
  let load  = if time >= 2 [s] then 0.5 [1/s] else 0 [1/s]
  flow { y' = 4 [1/s]*(u - y) + load }

  sample: every 10 [ms] { i := i + Ts*error
                          u := kp*error + ki*i }
}

system { loop = Loop() }

run { until 4 [s]  tolerance 1e-8  record loop every 0.01 [s] to "sampled_pi.csv" }
