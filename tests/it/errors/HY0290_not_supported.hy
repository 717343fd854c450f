import "other.hy"
property p = always time >= 0
