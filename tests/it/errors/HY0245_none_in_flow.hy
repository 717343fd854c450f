fn ahead(me: Car, other_one: Car) = other_one.x - me.x
agent Car(boss: Car) {
  state x = 0, v = 0, w = 0
  link lead: Car
  let gap = lead.x - x
  let safe = if not lead then inf else gap
  flow { x' = if lead and lead.v > 0 then lead.v else boss.v
         v' = gap + safe
         w' = ahead(self, lead) + ahead(self, boss) + (if lead then lead.lead.v else 0) }
}
