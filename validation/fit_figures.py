#!/usr/bin/env python3
"""Fits models/paper_train_figures.toml to the article's figures 3a and 3b.

    fit_figures.py HEADLAND [--write]

The article prints no parameters. Its figure 3b shows speeds of the mass centres between 17.86 and 18.14 m/s and power
on the drive between 172 and 186 kW over 15 s, figure 3a a path inside of x 10 .. 190 m, y -30 .. 190 m. Masses and
lengths stay those of models/paper_train.toml; the steering law, the drive and the start are fitted so that the four
extremes are met and the path stays inside, by Nelder and Mead's method on the binary HEADLAND. With --write the result
goes into the scene. Python's standard library alone.
"""

import csv
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
SCENE = os.path.join(HERE, "..", "models", "paper_train_figures.toml")

# Name, start, step, decimals in the scene.
PARAMETERS = [
    ("amp", 0.030, 0.002, 5),  # rad
    ("t_turn", 4.0, 0.6, 3),  # s
    ("tau", 1.0, 0.2, 3),  # s
    ("F0", 9600.0, 200.0, 1),  # N
    ("kp", 3300.0, 300.0, 1),  # N s/m
    ("resistance", 0.95, 0.03, 4),
    ("v0", 17.9, 0.03, 4),  # m/s
]
TARGETS = {"v_least": (17.86, 0.28), "v_most": (18.14, 0.28), "P_least": (172e3, 14e3), "P_most": (186e3, 14e3)}
FRAME = {"x_A1": (10.0, 190.0), "y_A1": (-30.0, 190.0)}


def run(headland, values, points=600):
    """Columns of a run with the given parameters."""
    with tempfile.TemporaryDirectory() as folder:
        command = [headland, "run", SCENE, "--out", folder, "--points", str(points), "--no-balance", "--json"]
        for (name, *_), value in zip(PARAMETERS, values):
            command += ["--set", f"{name}={value!r}"]
        if subprocess.run(command, capture_output=True).returncode != 0:
            return None
        with open(os.path.join(folder, "trajectory.csv"), newline="") as f:
            rows = list(csv.reader(f))
    names = [name.rsplit(" [", 1)[0] for name in rows[0]]
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(names)}


def extremes(columns):
    speeds = [v for name, column in columns.items() if name.startswith("v_C[") for v in column]
    power = columns["power"]
    return {"v_least": min(speeds), "v_most": max(speeds), "P_least": min(power), "P_most": max(power)}


def misfit(headland, values):
    """Squares of the errors in per cent of the figures' spans; metres outside of the frame; a light pull to round numbers."""
    columns = run(headland, values)
    if columns is None:
        return 1e9
    found = extremes(columns)
    error = sum((100 * (found[key] - target) / span) ** 2 for key, (target, span) in TARGETS.items())
    for name, (least, most) in FRAME.items():
        outside = max(0.0, least - min(columns[name]), max(columns[name]) - most)
        error += outside**2
    for (_, start, step, _), value in zip(PARAMETERS, values):
        error += 1e-3 * ((value - start) / step) ** 2
    return error


def nelder_mead(f, start, steps, evaluations):
    """The simplex method of 1965 with its usual coefficients."""
    n = len(start)
    points = [list(start)] + [[x + (s if i == j else 0.0) for j, (x, s) in enumerate(zip(start, steps))] for i in range(n)]
    simplex = sorted((f(p), p) for p in points)
    used = n + 1
    while used < evaluations and simplex[-1][0] - simplex[0][0] > 1e-9 * (1e-6 + simplex[0][0]):
        centre = [sum(p[j] for _, p in simplex[:-1]) / n for j in range(n)]

        def along(factor, centre=centre, worst=simplex[-1][1]):
            p = [c + factor * (c - w) for c, w in zip(centre, worst)]
            return f(p), p

        reflected = along(1.0)
        used += 1
        if reflected[0] < simplex[0][0]:
            simplex[-1] = min(reflected, along(2.0))
            used += 1
        elif reflected[0] < simplex[-2][0]:
            simplex[-1] = reflected
        else:
            contracted = along(0.5 if reflected[0] < simplex[-1][0] else -0.5)
            used += 1
            if contracted[0] < min(reflected[0], simplex[-1][0]):
                simplex[-1] = contracted
            else:
                best = simplex[0][1]
                shrunk = [[(b + x) / 2 for b, x in zip(best, p)] for _, p in simplex[1:]]
                simplex[1:] = [(f(p), p) for p in shrunk]
                used += n
        simplex.sort()
    return simplex[0]


def write(values):
    with open(SCENE, encoding="utf-8") as f:
        text = f.read()
    for (name, *_), value in zip(PARAMETERS, values):
        text, count = re.subn(rf'(?m)^({name} = "?)[-+.0-9eE]+', lambda m: m.group(1) + f"{value:g}", text)
        assert count == 1, name
    with open(SCENE, "w", encoding="utf-8") as f:
        f.write(text)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    headland = sys.argv[1]
    f = lambda values: misfit(headland, values)
    values, steps = [p[1] for p in PARAMETERS], [p[2] for p in PARAMETERS]
    for _ in range(6):  # restarts: a simplex may collapse
        error, values = nelder_mead(f, values, steps, 500)
        steps = [s / 2 for s in steps]
        print(f"misfit {error:.4f}  " + "  ".join(f"{p[0]} {v:.6g}" for p, v in zip(PARAMETERS, values)))
    values = [round(v, p[3]) for p, v in zip(PARAMETERS, values)]
    columns = run(headland, values, 3000)
    for key, value in extremes(columns).items():
        target, span = TARGETS[key]
        print(f"{key:8} {value:12.4f}  figure {target:10.2f}  error {100 * (value - target) / span:+.3f} % of the span")
    for name, (least, most) in FRAME.items():
        print(f"{name:8} {min(columns[name]):.2f} .. {max(columns[name]):.2f} m, frame {least} .. {most} m")
    if "--write" in sys.argv:
        write(values)


if __name__ == "__main__":
    main()
