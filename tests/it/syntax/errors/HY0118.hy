agent A { mode history { } }
// ----
agent A { when o is M.history -> B }
// ----
system { a = A in M.history }
// ----
agent A { when x > 0 -> M.history.N }
