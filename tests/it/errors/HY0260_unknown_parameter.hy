// -p n=3 -p H=2 -p raod=1
param road = 2000
let H = 3
