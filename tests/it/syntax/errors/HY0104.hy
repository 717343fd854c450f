let x = a + b)
// ----
agent A { }
}
// ----
agent A { state x }
}
