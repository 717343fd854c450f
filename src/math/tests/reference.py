"""Writes reference/*.csv: awkward arguments of every elementary function with their exact values.

Run as `python3 src/math/tests/reference.py` (needs mpmath). A row is the arguments, the nearest f64 to the exact
value, and what the exact value exceeds it by, in units in the last place of that f64.
"""

import math
import os
import random
import struct

from mpmath import mp, mpf

INF, NAN = math.inf, math.nan
COUNT = 160
HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "reference")
SPECIAL = [
    0.0, -0.0, 5e-324, -5e-324, 2.2250738585072014e-308, 2.225073858507201e-308, -1e-310, 1e-300, 1e-17, 1e-8, -1e-8,
    1.0, -1.0, 1.0000000000000002, 0.9999999999999999, -0.9999999999999999, 0.5, -0.5, 2.0, -2.0, 3.0, 10.0, -10.0,
    100.0, 1e16, 2.0**53, 1e22, 1e300, 1e308, 1.7976931348623157e308, -1.7976931348623157e308, INF, -INF, NAN,
    math.pi, math.pi / 2, math.pi / 4, math.e,
]
PAIRS = [0.0, -0.0, 1.0, -1.0, 2.0, -3.0, 0.5, INF, -INF, NAN, 5e-324, -1e-310, 1.7976931348623157e308]
ODD = {"sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "atanh", "cbrt"}
uniform = random.uniform


def near(x, steps):
    for _ in range(abs(steps)):
        x = math.nextafter(x, INF if steps > 0 else -INF)
    return x


def scale(low, high):
    """A positive number whose binary logarithm is uniform."""
    return 2.0 ** uniform(low, high)


def signed(x):
    return x if random.random() < 0.5 else -x


def any_finite():
    while True:
        x = struct.unpack("<d", struct.pack("<Q", random.getrandbits(64)))[0]
        if math.isfinite(x):
            return x


def many(share, draw):
    return [draw() for _ in range(COUNT // share)]


def near_quadrants(share, largest):
    """Doubles next to multiples of pi/2."""
    with mp.workprec(1300):
        return many(share, lambda: near(float(random.randint(1, largest) * mp.pi / 2), random.randint(-1, 1)))


def arguments(name):
    if name in ("sin", "cos", "tan"):
        # The first two come closest to a multiple of pi/2 of all doubles; the others stand at the reductions' seam.
        extra = [6381956970095103 * 2.0**797, 5319372648326541 * 2.0**255, 1.6e6, near(1.6e6, 1), -near(1.6e6, 1)]
        for largest in (20, 10**6, 10**9, 10**17, 10**100):
            extra += near_quadrants(8, largest)
        return extra + many(8, lambda: signed(scale(20, 1023))) + many(4, lambda: uniform(-7, 7))
    if name in ("exp", "sinh", "cosh", "tanh"):
        extra = [709.782712893384, 709.7827128933841, -745.1332191019411, -745.1332191019412, -708.3964, 710.4758600739439]
        extra += many(4, lambda: uniform(-746, 711)) + many(8, lambda: uniform(-745.2, -708))
        return extra + many(4, lambda: uniform(-1, 1)) + many(4, lambda: signed(scale(-60, 4)))
    if name in ("log", "log2", "log10"):
        extra = [near(root, k) for root in (1.0, 0.5**0.5, 2**0.5) for k in range(-2, 3)] + [2.0**-1074, 2.0**1023, 1e3]
        extra += many(4, lambda: abs(any_finite())) + many(4, lambda: uniform(0.5, 2)) + many(8, lambda: scale(-1070, -1020))
        return extra + many(4, lambda: 1 + signed(scale(-52, -2)))
    if name in ("asin", "acos", "atanh"):
        return many(2, lambda: uniform(-1, 1)) + many(4, lambda: signed(1 - scale(-53, -1)))
    if name == "acosh":
        return many(2, lambda: 1 + scale(-52, 1)) + many(4, lambda: scale(0, 1023)) + many(4, lambda: uniform(1, 20))
    if name == "atan":
        seams = [near(seam, k) for seam in (2**0.5 - 1, 2**0.5 + 1, 1.0) for k in range(-2, 3)]
        return seams + many(4, lambda: uniform(-1, 1)) + many(4, lambda: signed(scale(-4, 4))) + many(4, any_finite)
    return many(2, lambda: uniform(-4, 4)) + many(4, lambda: signed(scale(-60, 60))) + many(4, any_finite)


def pairs(name):
    rows = [(a, b) for a in PAIRS for b in PAIRS]
    if name == "pow":
        rows += many(4, lambda: (scale(-3, 3), uniform(-300, 300))) + many(4, lambda: (uniform(0, 10), uniform(-10, 10)))
        for base in many(4, lambda: 1 + signed(scale(-50, -1))) + many(4, lambda: abs(any_finite())):
            rows.append((base, uniform(-745, 709) / (math.log(base) or 1.0)))
        return rows + many(8, lambda: (-scale(-4, 4), float(random.randint(-50, 50))))
    rows += many(4, lambda: (signed(scale(-3, 3)), signed(scale(-3, 3)))) + many(4, lambda: (any_finite(), any_finite()))
    for x in many(4, lambda: signed(scale(-300, 300))):
        rows += [(x * signed(scale(-40, 40)), x), (near(x * (2**0.5 - 1), random.randint(-2, 2)), x)]
    return rows + many(8, lambda: (signed(scale(-1070, -1000)), signed(scale(-1070, -1000))))


def at_edge(name, x):
    """The value at infinity, a pole, outside the domain, or beyond the range; None elsewhere."""
    if math.isnan(x) or (math.isinf(x) and name in ("sin", "cos", "tan", "asin", "acos", "atanh")):
        return NAN
    if x == 0 and name in ODD:
        return x
    if name == "tanh" and abs(x) > 40:
        return math.copysign(1.0, x)
    if name in ("sinh", "cosh", "exp") and abs(x) > 800:
        return {"sinh": math.copysign(INF, x), "cosh": INF, "exp": INF if x > 0 else 0.0}[name]
    if name in ("log", "log2", "log10") and x <= 0:
        return -INF if x == 0 else NAN
    if (name in ("asin", "acos", "atanh") and abs(x) > 1) or (name == "acosh" and x < 1):
        return NAN
    if math.isinf(x) and name != "atan" or name == "atanh" and abs(x) == 1:
        return math.copysign(INF, x)
    return None


def value(name, x):
    edge = at_edge(name, x)
    if edge is not None:
        return edge
    with mp.workprec(1300):
        if name in ODD and name != "cbrt" and abs(x) < 1e-40:
            return mpf(x) * (1 + mpf(10) ** -60 * (1 if name in ("tan", "asin", "sinh", "atanh") else -1))
        if name == "cbrt":
            return mp.sign(x) * mp.cbrt(abs(mpf(x)))
        if name in ("log2", "log10"):
            return mp.log(mpf(x)) / mp.log(mpf(2 if name == "log2" else 10))
        return getattr(mp, name)(mpf(x))


def value_of_two(name, a, b):
    if name == "hypot":
        if math.isinf(a) or math.isinf(b):
            return INF
        with mp.workprec(4400):
            return NAN if math.isnan(a) or math.isnan(b) else mp.sqrt(mpf(a) ** 2 + mpf(b) ** 2)
    if name == "atan2":
        with mp.workprec(300):
            special = math.atan2(a, b)
            if math.isnan(special) or (a == 0 and math.copysign(1, b) > 0) or (math.isinf(b) and b > 0 and not math.isinf(a)):
                return special
            if a == 0 or b == 0 or math.isinf(a) or math.isinf(b):
                return mp.pi / 4 * round(special / (math.pi / 4))
            small = abs(mpf(a) / mpf(b)) < mpf(10) ** -40 and b > 0
            return mpf(a) / mpf(b) if small else mp.atan2(mpf(a), mpf(b))
    if not (math.isfinite(a) and math.isfinite(b)) or a == 0 or b == 0:
        try:
            return math.pow(a, b)
        except ValueError:  # a pole: zero to a negative power
            return math.copysign(INF, a) if b % 2 == 1 else INF
    if a < 0 and b != int(b):
        return NAN
    sign = -1 if a < 0 and b % 2 == 1 else 1
    with mp.workprec(300):
        power = mpf(b) * mp.log(abs(mpf(a)))
        return sign * INF if power > 710 else sign * 0.0 if power < -750 else sign * mp.exp(power)


def row(inputs, exact):
    """The arguments, the nearest f64 and the excess of the exact value over it."""
    nearest, excess = exact, 0.0
    if not isinstance(exact, float):
        with mp.workprec(4400):
            exponent = -1022 if exact == 0 else max(int(mp.floor(mp.log(abs(exact), 2))), -1022)
            steps = int(mp.nint(abs(exact) / mpf(2) ** (exponent - 52)))
            too_large = exponent > 1023 or (exponent == 1023 and steps == 2**53)
            nearest = INF if too_large else math.ldexp(steps, exponent - 52)
            nearest = -nearest if exact < 0 else nearest
            if not too_large:
                excess = float((exact - mpf(nearest)) / mpf(math.ulp(nearest)))
    return ",".join([repr(x) for x in inputs] + [repr(nearest), "%.4f" % excess])


def write(name, rows):
    with open(os.path.join(HERE, name + ".csv"), "w") as out:
        out.write("\n".join(rows) + "\n")


def main():
    random.seed(2004)
    for name in "sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh exp log log2 log10 cbrt".split():
        write(name, [row((x,), value(name, x)) for x in SPECIAL + arguments(name)])
    for name in ("pow", "atan2", "hypot"):
        write(name, [row(pair, value_of_two(name, *pair)) for pair in pairs(name)])


main()
