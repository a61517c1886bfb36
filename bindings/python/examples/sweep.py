"""How sharply may the train be steered? Runs side by side in threads; the largest angles at the
hinges, and the speed that is left.

    python sweep.py
"""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import headland

SCENE = Path(__file__).resolve().parents[3] / "models" / "paper_train.toml"


def steer(degrees):
    scene = headland.Scene.load(SCENE)
    scene["gamma"] = f"{degrees}[deg]/2*(1 + tanh((t - 3)/1.0))"
    result = scene.build().run(until=20, points=400)
    angle = np.degrees([np.abs(result[f"psi[{k}]"]).max() for k in (1, 2, 3)])
    return angle, result["v"][-1], result.summary["energy_balance"]


def main():
    amplitudes = [0.5, 1.0, 2.0, 4.0, 8.0, 12.0]
    with ThreadPoolExecutor() as pool:
        print("steered [deg]  psi_1  psi_2  psi_3 [deg]  v [m/s]  energy balance")
        for degrees, (angle, speed, balance) in zip(amplitudes, pool.map(steer, amplitudes)):
            print(f"{degrees:13.1f}  {angle[0]:5.2f}  {angle[1]:5.2f}  {angle[2]:5.2f}        {speed:7.3f}  {balance:14.1e}")


if __name__ == "__main__":
    main()
