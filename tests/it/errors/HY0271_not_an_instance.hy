agent Car { link lead: Car link back: Car }
system { cars = Car[3](lead = cars, back = car)
         solo = Car(lead = solo[0], back = 3) }
