param N: int = 5/2
agent Car { discrete lane: int = 1 when lane > 3 { lane := 0.5*lane } }
