param n: int [m] = 3
