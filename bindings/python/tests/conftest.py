"""Scenes that the tests share."""

from pathlib import Path

import pytest

import headland

ROOT = Path(__file__).resolve().parents[3]

STONE = """
title = "Stone that falls"
[coordinates]
z = "m"
[[inertia]]
name = "m"
value = "1 kg"
geometric = "z"
[[force]]
name = "weight"
value = "-9.81 N"
geometric = "z"
[initial]
z = "20 m"
"z'" = 0
"""

GROUND = """
[[event]]
name = "ground"
quantity = "z"
direction = "falling"
stop = true
"""

GUARD = """
[[guard]]
name = "height"
quantity = "z"
warn_below = "10 m"
stop_below = "5 m"
message = "the net is there"
"""

PENDULUMS = """
title = "Pendulums that hang from each other"
[indices]
k = 3
j = "2"
[parameters]
m = "0.5 kg"
l = "0.3 m"
g = "9.81 m/s^2"
[coordinates]
"phi[k]" = "rad"
[definitions]
"x[1]" = "l*sin(phi[1])"
"y[1]" = "-l*cos(phi[1])"
"x[j+1]" = "x[j] + l*sin(phi[j+1])"
"y[j+1]" = "y[j] - l*cos(phi[j+1])"
[[inertia]]
name = "m[k], x"
value = "m"
geometric = "x[k]"
[[inertia]]
name = "m[k], y"
value = "m"
geometric = "y[k]"
[[force]]
name = "weight[k]"
value = "-m*g"
geometric = "y[k]"
[initial]
"phi[k]" = "0.3*cos(2*k)"
"phi[k]'" = "0.5*sin(k)"
"""


@pytest.fixture
def root():
    return ROOT


@pytest.fixture
def train():
    return headland.Scene.load(ROOT / "models" / "paper_train.toml")


@pytest.fixture
def stone():
    return headland.Scene.parse(STONE, name="stone.toml")


def pendulums(n):
    scene = headland.Scene.parse(PENDULUMS, name="pendulums.toml")
    scene["k"] = n
    scene["j"] = n - 1
    return scene
