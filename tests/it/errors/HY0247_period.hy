agent Car { every 0 [ms] { } after -1 { } }
