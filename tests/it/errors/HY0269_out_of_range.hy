agent Car { link lead: Car }
system { cars = Car[3](lead = cars[index - 1]) }
