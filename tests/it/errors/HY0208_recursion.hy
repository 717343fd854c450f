fn even(n: int): bool = if n == 0 then true else odd(n - 1)
fn odd(n: int): bool = if n == 0 then false else even(n - 1)
