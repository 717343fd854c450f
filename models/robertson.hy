// robertson.hy: a slow reaction feeds a fast one, of which a little catalyses the way back; rates nine orders apart.
// Shows a stiff flow: after a millisecond explicit steps would have to be as short as the fast reaction for all of the
// 1e11 s; the automatic choice takes steps as long as the slow one lets it. H. H. Robertson, 1966.

param slow = 0.04                            // a -> b, 1/s
param back = 1e4                             // b + c -> a + c
param fast = 3e7                             // b + b -> b + c

agent Vessel {
  state a = 1, b = 0, c = 0
  discrete passed: int = 0
  flow { a' = back*b*c - slow*a
         b' = slow*a - back*b*c - fast*b^2
         c' = fast*b^2 }
  trace:   when c >= 0.01         { passed := passed + 1 }
  half:    when a <= 0.5          { passed := passed + 1 }
  starved: when rising(b <= 1e-6) { passed := passed + 1 }
  tenth:   when a <= 0.1          { passed := passed + 1 }
  last:    when a <= 1e-4         { passed := passed + 1 }
}

system { vessel = Vessel() }

run {
  until 1e11  tolerance 1e-8  absolute 1e-16
  record vessel to "robertson.csv"  events to "robertson_events.csv"
}
