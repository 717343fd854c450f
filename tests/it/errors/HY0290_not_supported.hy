property p = always time >= 0
