"""How fast may the train enter the bend? Runs side by side in threads, a table of the largest angle between bogies.

    python sweep.py [SCENE]
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import headland

MODELS = Path(__file__).resolve().parents[3] / "models"


def largest_angle(path, speed):
    scene = headland.Scene.load(path)
    scene["v0"] = scene["v_ref"] = speed
    result = scene.build().run(until=20, points=400)
    return np.degrees(max(np.abs(result[f"psi[{k}]"]).max() for k in (2, 3))), result.summary["energy_balance"]


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else MODELS / "paper_train.toml"
    speeds = np.arange(6.0, 25.0, 3.0)
    with ThreadPoolExecutor() as pool:
        rows = pool.map(lambda v: largest_angle(path, v), speeds)
        print("v [m/s]  angle [deg]  energy balance")
        for v, (angle, balance) in zip(speeds, rows):
            print(f"{v:7.1f}  {angle:11.4f}  {balance:14.1e}")


if __name__ == "__main__":
    main()
