"""The train of benchmarks.md by SymPy's KanesMethod and by hand in Python, both integrated by SciPy's DOP853.

    python -m venv venv && venv/bin/pip install numpy scipy sympy
    venv/bin/python docs/benchmarks_sympy.py 1 2 3 4 8

Prints one line of JSON a size. Times are the least of several.
"""

import json
import math
import sys
import time

import numpy as np
import sympy as sm
import sympy.physics.mechanics as me
from scipy.integrate import solve_ivp

UNTIL, TOLERANCE = 15.0, 1e-9


def parameters(n):
    """A tractor, then equal trailers; the same numbers as in crates/headland/benches/train/mod.rs."""
    row = lambda first, following: [first] + [following] * (n - 1)
    p = dict(l=row(4.0, 6.0), a=row(1.0, 1.2), b=row(2.0, 3.0), m=row(8000.0, 12000.0), J=row(20000.0, 60000.0))
    p["a"][-1] = 0.0
    p["F"] = row(3000.0, 3400.0)
    return p | dict(F0=sum(p["F"]), kp=2000.0, v_ref=18.0, v0=18.0)


def steering(t):
    tanh = math.tanh(t - 3.0)
    return 0.015 * (1.0 + tanh), 0.015 * (1.0 - tanh * tanh)


def kane(n):
    """Coordinates x, y, theta_k; speeds v (kept), w and omega_k (given by the rows: steered wheel, axles)."""
    t = me.dynamicsymbols._t
    gamma = sm.Function("gamma")(t)
    x, y, v, w = me.dynamicsymbols("x y v w")
    theta, omega = list(me.dynamicsymbols(f"theta1:{n + 1}")), list(me.dynamicsymbols(f"omega1:{n + 1}"))
    l, a, b, m, J, F = (sm.symbols(f"{c}1:{n + 1}") for c in "labmJF")
    F0, kp, v_ref = sm.symbols("F0 kp v_ref")
    N, O = me.ReferenceFrame("N"), me.Point("O")
    O.set_vel(N, 0)
    H = N.orientnew("H", "axis", (theta[0] + gamma, N.z))
    hinge = O.locatenew("A1", x * N.x + y * N.y)
    hinge.set_vel(N, v * H.x + w * H.y)
    s, c = sm.sin(theta[0] + gamma), sm.cos(theta[0] + gamma)
    kinematics = [x.diff() - (v * c - w * s), y.diff() - (v * s + w * c)]
    kinematics += [q.diff() - u for q, u in zip(theta, omega)]
    bodies, loads, rows = [], [(hinge, (F0 + kp * (v_ref - v)) * H.x)], [w]
    for k in range(n):
        E = N.orientnew(f"E{k}", "axis", (theta[k], N.z))
        E.set_ang_vel(N, omega[k] * N.z)
        axle = hinge.locatenew(f"B{k}", -l[k] * E.x)
        axle.v2pt_theory(hinge, N, E)
        centre = axle.locatenew(f"C{k}", b[k] * E.x)
        centre.v2pt_theory(hinge, N, E)
        bodies.append(me.RigidBody(f"bogie{k}", centre, E, m[k], (me.inertia(E, 0, 0, J[k]), centre)))
        loads.append((axle, -F[k] * E.x))
        rows.append(axle.vel(N).dot(E.y))
        following = axle.locatenew(f"A{k + 2}", -a[k] * E.x)
        following.v2pt_theory(hinge, N, E)
        hinge = following
    method = me.KanesMethod(
        N, q_ind=[x, y] + theta, u_ind=[v], u_dependent=[w] + omega, kd_eqs=kinematics, velocity_constraints=rows
    )
    method.kanes_equations(bodies, loads)
    return method, gamma, [x, y] + theta, [v, w] + omega, [*l, *a, *b, *m, *J, *F, F0, kp, v_ref]


def kane_function(n, method, gamma, q, u, symbols):
    p = parameters(n)
    values = [*p["l"], *p["a"], *p["b"], *p["m"], *p["J"], *p["F"], p["F0"], p["kp"], p["v_ref"]]
    at, rate = sm.symbols("gamma0 gamma1")
    put = lambda e: e.subs(gamma.diff(me.dynamicsymbols._t), rate).subs(gamma, at)
    matrices = put(method.mass_matrix_full), put(method.forcing_full)
    f = sm.lambdify((q + u, [at, rate], symbols), matrices, cse=True)

    def rhs(t, y):
        M, force = f(y, steering(t), values)
        return np.linalg.solve(M, force[:, 0])

    return rhs


def kane_start(n):
    """On the rows: the steering angle is not zero at t = 0."""
    p = parameters(n)
    y = np.zeros(4 + 2 * n)
    v, psi = p["v0"], steering(0.0)[0]
    y[2 + n] = v
    for k in range(n):
        alpha = p["a"][k] / p["l"][k]
        y[4 + n + k] = v * math.sin(psi) / p["l"][k]
        v, psi = v * math.hypot(math.cos(psi), alpha * math.sin(psi)), -math.atan(alpha * math.tan(psi))
    return y


def by_hand(n):
    """(12)-(16) with psi' and (v_A/v)' handed down the train; y = [x, y, theta, v]."""
    p = parameters(n)
    l, a, b, m, J, F = (p[c] for c in "labmJF")

    def rhs(t, y):
        y = y.tolist()
        v = y[n + 2]
        gamma, psi_rate = steering(t)
        psi, r, r_rate, mass, half, resistance = gamma, 1.0, 0.0, 0.0, 0.0, 0.0
        dy = [v * math.cos(y[2] + gamma), v * math.sin(y[2] + gamma)]
        for k in range(n):
            s, c, alpha, beta = math.sin(psi), math.cos(psi), a[k] / l[k], b[k] / l[k]
            turn, turn_rate = r * s / l[k], (r_rate * s + r * c * psi_rate) / l[k]
            g, half_g = c * c + beta * beta * s * s, (beta * beta - 1) * s * c * psi_rate
            mass += m[k] * r * r * g + J[k] * turn * turn
            half += m[k] * r * (r_rate * g + r * half_g) + J[k] * turn * turn_rate
            resistance += F[k] * r * c
            dy.append(v * turn)
            if k + 1 < n:
                h2 = c * c + alpha * alpha * s * s
                h, delta_rate = math.sqrt(h2), alpha * psi_rate / h2
                r_rate = r_rate * h + r * (alpha * alpha - 1) * s * c * psi_rate / h
                r *= h
                psi = y[2 + k] - y[3 + k] - math.atan2(alpha * s, c)
                psi_rate = v * turn - v * r * math.sin(psi) / l[k + 1] - delta_rate
        dy.append((p["F0"] + p["kp"] * (p["v_ref"] - v) - resistance - half * v) / mass)
        return dy

    return rhs


def least(repeats, f):
    times = []
    for _ in range(repeats):
        clock = time.perf_counter()
        result = f()
        times.append(time.perf_counter() - clock)
    return min(times), result


def run(rhs, y, tolerance=TOLERANCE):
    return solve_ivp(rhs, (0.0, UNTIL), y, method="DOP853", rtol=tolerance, atol=tolerance)


def main():
    for n in map(int, sys.argv[1:] or "123"):
        derive_s, derived = least(1, lambda: kane(n))
        lambdify_s, rhs = least(1, lambda: kane_function(n, *derived))
        y0 = kane_start(n)
        eval_s, _ = least(1000, lambda: rhs(2.9, y0))
        run_s, result = least(7, lambda: run(rhs, y0))
        hand, h0 = by_hand(n), np.array([0.0] * (n + 2) + [18.0])
        hand_eval_s, _ = least(3000, lambda: hand(2.9, h0))
        hand_run_s, hand_result = least(15, lambda: run(hand, h0))
        exact = run(hand, h0, 1e-13).y[:, -1]
        end = result.y[:, -1]
        error = lambda y: float(max(abs(y - exact) / np.maximum(1.0, abs(exact))))
        us = lambda s: round(s * 1e6, 1)
        print(json.dumps({
            "n": n, "derive_s": round(derive_s, 3), "lambdify_s": round(lambdify_s, 3), "eval_us": us(eval_s),
            "run_us": us(run_s), "steps": len(result.t) - 1, "rhs": result.nfev,
            "error": error(np.append(end[: n + 2], end[n + 2])),
            "hand_eval_us": us(hand_eval_s), "hand_run_us": us(hand_run_s), "hand_steps": len(hand_result.t) - 1,
            "hand_rhs": hand_result.nfev, "hand_error": error(hand_result.y[:, -1]),
        }), flush=True)


main()
