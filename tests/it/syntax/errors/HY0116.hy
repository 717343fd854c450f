let x = (a + b)(c + d)
// ----
let x = lead.f(3)
// ----
let x = 2(a + b)
// ----
let x = 2 (a + b)
