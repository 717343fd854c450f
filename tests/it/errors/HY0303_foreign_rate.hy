// The rate of another agent in a flow.
agent Lead {
  state x = 0
  flow { x' = 2 }
}
agent Car(lead: Lead) {
  state x = 0
  flow { x' = lead.x' - x }
}
system { a = Lead  b = Car(lead = a) }
run { until 1 }
