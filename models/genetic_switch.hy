// genetic_switch.hy: luminous bacteria count themselves by a signal that all of them leak, and light up when they are many.
// Twice they are flushed into fresh water: they go dark, grow, and light up again.
// Shows modes by thresholds of a concentration, between which the flow is continuous: without hysteresis, and without
// chattering; and a reset that crosses two thresholds in one instant. After R. Alur and others, 2001: transcription does
// nothing below one threshold, rises linearly up to another, and is at its full rate beyond.

param growth: real [1/h]      = 1.2
param leak:   real [nmol/L/h] = 1            // of signal, by a full colony in the dark
param boost:  real [1/h]      = 0.1          // more of it for each nmol/L of enzyme
param full:   real [nmol/L/h] = 50           // at most so much enzyme is made
param low:    real [nmol/L]   = 0.5          // thresholds of the signal
param high:   real [nmol/L]   = 5
param d_signal: real [1/h]    = 1            // decays
param d_enzyme: real [1/h]    = 0.5

agent Colony {
  state n: real               = 0.01,        // size, as a share of what the water can feed
        signal: real [nmol/L] = 0,
        enzyme: real [nmol/L] = 0            // makes light, and signal
  let light = n*enzyme
  flow { n'      = growth*n*(1 - n)
         signal' = n*(leak + boost*enzyme) - d_signal*signal }
  flush: every 15 [h] { n := n/50  signal := signal/50 }

  initial mode Dark {
    flow { enzyme' = -d_enzyme*enzyme }
    waken: when signal >= low -> Rising
  }
  mode Rising {
    flow { enzyme' = full*(signal - low)/(high - low) - d_enzyme*enzyme }
    fade:  when signal < low -> Dark
    reach: when signal >= high -> Bright
  }
  mode Bright {
    flow { enzyme' = full - d_enzyme*enzyme }
    dim: when signal < high -> Rising
  }
}

system { colony = Colony() }

run {
  until 44 [h]  tolerance 1e-9  absolute 1e-15          // in SI: 1 nmol/L is 1e-6 mol/m^3
  record colony, colony.light every 0.1 [h] to "genetic_switch.csv"  events to "genes.csv"
}
