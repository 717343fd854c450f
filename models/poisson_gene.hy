// poisson_gene.hy: a gene is read at random: messenger molecules come and go one by one, and each makes protein steadily.
// The number of messengers is a Poisson process with deaths, whose mean and variance are known at every time, and so are those of
// the protein, which is driven by it: transcription noise filtered by translation.
// Shows `rate` transitions, whose hazards are constant or follow a discrete variable, beside a flow; one stream of random numbers
// for each cell. After J. Paulsson, Physics of Life Reviews 2 (2005).

param cells: int = 100
param k_m: real [1/min] = 2                  // messengers made
param d_m: real [1/min] = 0.2                // each is lost at this rate
param k_p: real [1/min] = 1.5                // protein made by each, in arbitrary units
param d_p: real [1/min] = 0.05

agent Cell {
  discrete m: int = 0
  state p = 0
  flow { p' = k_p*m - d_p*p }
  read: rate k_m { m := m + 1 }
  lose: rate d_m*m when m > 0 { m := m - 1 }
}

system { colony = Cell[cells] }

run {
  until 60 [min]  seed 1
  record colony every 1 [min] to "poisson_gene.csv"
}
