agent Car {
  state v: real [m/s] = 0 [Km/hr]
  flow { v' = 1 [m/s^2] }
  fast: when v >= 120 [km/hr] { v := 0 [mph/s] }
  warm: when v >= 20 [degC] { v := 0 }
}
run { until 1 [sec] }
