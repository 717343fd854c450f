// -p N=2.5 -p road=far -p lit=1
param N: int = 3
param road = 2000
param lit = true
