"""The equations as functions: a classical Runge-Kutta step of one's own, and the eigenvalues at the start.

    python own_integrator.py [SCENE]
"""

import sys
from pathlib import Path

import numpy as np

import headland

MODELS = Path(__file__).resolve().parents[3] / "models"


def main():
    scene = headland.Scene.load(sys.argv[1] if len(sys.argv) > 1 else MODELS / "double_pendulum.toml")
    model = scene.build()
    eq = model.equations()
    print(eq.text())
    t, q, u = eq.state0
    nq = len(q)
    print("eigenvalues at the start:", np.linalg.eigvals(eq.jacobian(t, q, u)))

    def rate(t, y):
        return np.concatenate([eq.rates(t, y[:nq], y[nq:]), eq.acceleration(t, y[:nq], y[nq:])])

    y, h = np.concatenate([q, u]), 1e-3
    for _ in range(1000):
        k1 = rate(t, y)
        k2 = rate(t + h / 2, y + h / 2 * k1)
        k3 = rate(t + h / 2, y + h / 2 * k2)
        k4 = rate(t + h, y + h * k3)
        t, y = t + h, y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    for name, value in zip([*eq.names.q, *eq.names.u], y):
        print(f"{name} = {value:.9f} at t = {t:.3f} s")


if __name__ == "__main__":
    main()
