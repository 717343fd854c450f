let x = 1e999 [m]
