agent Car { }
system { a = Car() }
system { b = Car() }
