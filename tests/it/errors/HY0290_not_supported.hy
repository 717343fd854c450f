property p = always time >= 0 until time >= 1
