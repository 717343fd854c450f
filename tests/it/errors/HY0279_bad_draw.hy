agent Car(v: real) {
  state x ~ Uniform(v, -v), y ~ Exponential(v - 1)
  flow { x' = v y' = 0 }
}
system { slow = Car[2](v ~ Normal(0, index - 1)) fast = Car[2](v = 1 - index) last = Car(v ~ Uniform(0, 1/0)) }
