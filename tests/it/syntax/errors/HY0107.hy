let x = 1.
// ----
let x = .5
// ----
let x = 3x
// ----
let x = 1e
// ----
let x = 1_000
// ----
let x = 1.2.3
// ----
let x = 0x1f
