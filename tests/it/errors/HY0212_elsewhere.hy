let a = ln(3) + pow(2, 3) + sqr(2) + fabs(-1) + arctan(1) + fmod(5, 3) + sgn(2) + ceiling(1.5) + int(1.5) + rand() + dist(3, 4)
