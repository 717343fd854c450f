param x: real [m] = 2
let   y = (x^30000)^2
let   z = sqrt(x)^(1/99)*cbrt(x)^(1/97)
