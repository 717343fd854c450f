param early = -1
property p = always [3, 2] time >= 0
property q = time >= 0 until [early, 2 [min]] time >= 1
property r = eventually [0, always_] time >= 0
property s = eventually [0 [m], inf] time >= 0
