let x = $a
// ----
# a comment
let x = 3
// ----
let x = 3 − 1
// ----
let größe = 3
// ----
let x = a ≤ b
// ----
let x = “text”
// ----
let y = c ? a : b
