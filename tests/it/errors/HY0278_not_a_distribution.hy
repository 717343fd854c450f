agent Car(v: real) {
  state x ~ 3, y ~ Cauchy(0, 1), z ~ (Uniform(0, 1))
  discrete k: int ~ Uniform(0, 6), n ~ Normal(0)
  flow { x' = v y' = 0 z' = 0 }
}
system { car = Car(v ~ 2*Normal(0, 1)) }
