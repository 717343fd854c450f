agent A { initial mode P { after 1 -> Q.history }  mode Q { after 1 -> P } }
