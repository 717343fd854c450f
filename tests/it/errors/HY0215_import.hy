import "none/walker.hy"
system { a = Walker() }
