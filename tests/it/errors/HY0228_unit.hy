param a: real [m/ss] = 3
let b = 20 [degC]
let c = 3 [m^]
