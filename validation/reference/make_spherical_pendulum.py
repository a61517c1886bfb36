#!/usr/bin/env python3
"""Reference values for validation/scenes/spherical_double_pendulum.toml: `spherical_pendulum.json`.

Two rigid bodies on ball joints, without symmetry. Newton's and Euler's equations of both bodies with the forces F1, F2 in
the joints eliminated by hand; orientations by quaternions, not normalised while running (their length is checked):

    m2 (a2 - g) = F2                 I2 w2' + w2 x I2 w2 = -c2 x F2
    m1 (a1 - g) = F1 - F2            I1 w1' + w1 x I1 w1 = -c1 x F1 - (h - c1) x F2

Gragg-Bulirsch-Stoer extrapolation in decimal arithmetic; two runs  1/25 s, 12 columns with step
1/40 s) must agree to 18 digits. Python's standard library alone; a few minutes.
"""

import json
import os
from decimal import Decimal as D, getcontext

getcontext().prec = 36
M = [D("1.2"), D("0.8")]
C = [[D("0.02"), D("-0.01"), D("-0.5")], [D("0.01"), D("0.02"), D("-0.4")]]
H = [D("0"), D("0.03"), D("-1")]
I = [
    [[D("0.11"), D("0.004"), D("-0.003")], [D("0.004"), D("0.09"), D("0.002")], [D("-0.003"), D("0.002"), D("0.03")]],
    [[D("0.05"), D("0"), D("0.002")], [D("0"), D("0.06"), D("-0.001")], [D("0.002"), D("-0.001"), D("0.02")]],
]
G = [D(0), D(0), D("-9.81")]
W0 = [[D("1.5"), D("-0.7"), D("2.0")], [D("-2.0"), D("1.0"), D("3.0")]]
Q0 = [[D("0.8"), D("0.6"), D(0), D(0)], [D("0.6"), D(0), D("0.8"), D(0)]]
TIMES = ["1", "2", "3"]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def add(*vectors):
    return [sum(x) for x in zip(*vectors)]


def times(matrix, v):
    return [sum(a * b for a, b in zip(row, v)) for row in matrix]


def rotation(q):
    w, x, y, z = q
    return [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]


def transposed(r):
    return [list(column) for column in zip(*r)]


def scaled(v, k):
    return [k * x for x in v]


def defect(r, w, alpha):
    """What is left of Euler's equations; affine in the angular accelerations."""
    arm = lambda b, p: times(r[b], add(cross(alpha[b], p), cross(w[b], cross(w[b], p))))
    a1 = arm(0, C[0])
    a2 = add(arm(0, H), arm(1, C[1]))
    down = scaled(G, D(-1))
    f2 = scaled(add(a2, down), M[1])
    f1 = add(scaled(add(a1, down), M[0]), f2)
    left = []
    for b in range(2):
        rt = transposed(r[b])
        torque = cross(C[b], times(rt, f1 if b == 0 else f2))
        if b == 0:
            torque = add(torque, cross(add(H, scaled(C[0], D(-1))), times(rt, f2)))
        left += add(times(I[b], alpha[b]), cross(w[b], times(I[b], w[b])), torque)
    return left


def solve(a, b):
    n = len(b)
    a = [row[:] + [x] for row, x in zip(a, b)]
    for i in range(n):
        p = max(range(i, n), key=lambda k: abs(a[k][i]))
        a[i], a[p] = a[p], a[i]
        for k in range(i + 1, n):
            f = a[k][i] / a[i][i]
            if f:
                a[k] = [x - f * y for x, y in zip(a[k], a[i])]
    x = [D(0)] * n
    for i in reversed(range(n)):
        x[i] = (a[i][n] - sum(a[i][k] * x[k] for k in range(i + 1, n))) / a[i][i]
    return x


def rates(y):
    q, w = [y[0:4], y[7:11]], [y[4:7], y[11:14]]
    r = [rotation(q[0]), rotation(q[1])]
    zero = [[D(0)] * 3, [D(0)] * 3]
    base = defect(r, w, zero)
    columns = []
    for k in range(6):
        alpha = [v[:] for v in zero]
        alpha[k // 3][k % 3] = D(1)
        columns.append([x - b for x, b in zip(defect(r, w, alpha), base)])
    alpha = solve(transposed(columns), scaled(base, D(-1)))
    dy = []
    for b in range(2):
        s, x, y_, z = q[b]
        p = w[b]
        dy += [
            -(x * p[0] + y_ * p[1] + z * p[2]) / 2,
            (s * p[0] + y_ * p[2] - z * p[1]) / 2,
            (s * p[1] + z * p[0] - x * p[2]) / 2,
            (s * p[2] + x * p[1] - y_ * p[0]) / 2,
        ]
        dy += alpha[3 * b : 3 * b + 3]
    return dy


def step(y, big, columns):
    """Gragg's midpoint rule with 2, 4, 6, .. steps, extrapolated to none."""
    table = []
    first = rates(y)
    for k in range(1, columns + 1):
        n = 2 * k
        h = big / n
        old, new = y, [a + h * b for a, b in zip(y, first)]
        for _ in range(n - 1):
            f = rates(new)
            old, new = new, [a + 2 * h * b for a, b in zip(old, f)]
        row = [[(a + b + h * c) / 2 for a, b, c in zip(old, new, rates(new))]]
        for j in range(1, k):
            ratio = (D(k) / D(k - j)) ** 2 - 1
            row.append([a + (a - b) / ratio for a, b in zip(row[-1], table[-1][j - 1])])
        table.append(row)
    return table[-1][-1]


def run(steps_per_second, columns):
    y = Q0[0] + W0[0] + Q0[1] + W0[1]
    values = {}
    for t in range(1, int(TIMES[-1]) + 1):
        for _ in range(steps_per_second):
            y = step(y, D(1) / steps_per_second, columns)
        r = [rotation(y[0:4]), rotation(y[7:11])]
        elbow = times(r[0], H)
        centre = add(elbow, times(r[1], C[1]))
        values[str(t)] = {"elbow": elbow, "centre": centre, "w1": y[4:7], "w2": y[11:14]}
        length = max(abs(sum(x * x for x in y[i : i + 4]) - 1) for i in (0, 7))
        assert length < D("1e-17"), length
    return values


def main():
    good, other = run(100, 12), run(64, 14)
    for t in TIMES:
        for key, value in good[t].items():
            worst = max(abs(a - b) for a, b in zip(value, other[t][key]))
            assert worst < D("1e-16"), (t, key, worst)
    text = {
        "status": "reference",
        "source": "computed here by make_spherical_pendulum.py",
        "values": {t: {k: [format(x, ".24e") for x in v] for k, v in good[t].items()} for t in TIMES},
    }
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "spherical_pendulum.json")
    with open(path, "w") as f:
        json.dump(text, f, indent=1)
        f.write("\n")


if __name__ == "__main__":
    main()
