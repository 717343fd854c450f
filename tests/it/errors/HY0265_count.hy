param N = 2.5
agent Car { }
system { a = Car[N] b = Car[-1] }
