#!/usr/bin/env python3
"""Reference values for models/pendulum_prescribed_pivot.toml: `prescribed_pivot.json`.

    l phi'' = -(g + y'') sin phi,   y = A cos(Omega t),   phi(0) = phi0, phi'(0) = 0

integrated by Taylor series in decimal arithmetic. The trigonometric functions are carried as solutions of their own
differential equations. Two runs (order 34 with step 1/500 s, order 28 with step 1/800 s) must agree to 20 digits.
Python's standard library alone; a few seconds.
"""

import json
import os
from decimal import Decimal as D, getcontext

getcontext().prec = 45
L, G, A, OMEGA, PHI0 = D("0.25"), D("9.81"), D("0.02"), D(180), D("2.8")
TIMES = [D("0.5"), D(1), D(2), D(5)]


def sine(x):
    """sin and cos by their series, at the start only."""
    s, c, term, n = D(0), D(0), D(1), 0
    while abs(term) > D(10) ** -50:
        if n % 2 == 0:
            c += term if n % 4 == 0 else -term
        else:
            s += term if n % 4 == 1 else -term
        n += 1
        term = term * x / n
    return s, c


def step(state, h, order):
    """One Taylor step of (phi, phi', sin phi, cos phi, cos Omega t, sin Omega t)."""
    p, w, s, c, x, z = [[v] for v in state]
    for n in range(order):
        # a = -(g - A Omega^2 cos(Omega t))/l
        force = sum(x[i] * s[n - i] for i in range(n + 1)) * A * OMEGA**2 - G * s[n]
        p.append(w[n] / (n + 1))
        w.append(force / L / (n + 1))
        s.append(sum(w[i] * c[n - i] for i in range(n + 1)) / (n + 1))
        c.append(-sum(w[i] * s[n - i] for i in range(n + 1)) / (n + 1))
        x.append(-OMEGA * z[n] / (n + 1))
        z.append(OMEGA * x[n] / (n + 1))
    result = []
    for series in (p, w, s, c, x, z):
        value = D(0)
        for coefficient in reversed(series):
            value = value * h + coefficient
        result.append(value)
    return result


def run(steps_per_second, order):
    s, c = sine(PHI0)
    state = [PHI0, D(0), s, c, D(1), D(0)]
    h = D(1) / steps_per_second
    wanted = {int(t * steps_per_second): t for t in TIMES}
    found = {}
    for n in range(1, int(TIMES[-1] * steps_per_second) + 1):
        state = step(state, h, order)
        if n in wanted:
            found[str(wanted[n])] = (state[0], state[1])
    return found


def main():
    one, two = run(500, 34), run(800, 28)
    worst = max(abs(a - b) for t in one for a, b in zip(one[t], two[t]))
    assert worst < D(10) ** -20, worst
    values = {t: {"phi": f"{v[0]:.22f}", "phi_dot": f"{v[1]:.22f}"} for t, v in one.items()}
    reference = {
        "status": "reference",
        "source": "make_prescribed_pivot.py: Taylor series of l phi'' = -(g + y'') sin phi in 45-digit decimal arithmetic",
        "parameters": {"l": "0.25", "g": "9.81", "amplitude": "0.02", "Omega": "180", "phi0": "2.8"},
        "values": values,
    }
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "prescribed_pivot.json")
    with open(path, "w") as f:
        json.dump(reference, f, indent=1)
        f.write("\n")
    print(f"two runs differ by {worst:.1e}")


if __name__ == "__main__":
    main()
