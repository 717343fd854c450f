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
// ----
agent A { when x > 0.5 AND x < 1 { x := 0 } }
// ----
let a = b OR c
// ----
let a = b mod 3
// ----
let a = b div 3
// ----
let a = b xor c
