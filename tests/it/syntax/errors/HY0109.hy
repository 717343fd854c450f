let x = a && b
// ----
let x = a || b
// ----
let x = !a
// ----
let x = a ** 2
// ----
let x = a % 2
// ----
agent A { when a { x += 1 } }
// ----
/* a comment */ let x = 3
// ----
agent A { when a => B }
