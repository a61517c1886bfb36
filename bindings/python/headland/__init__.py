"""Multibody dynamics for wheeled, rolling and coupled machines.

>>> import headland
>>> scene = headland.Scene.load("models/paper_train.toml")
>>> scene["v0"] = "17 m/s"
>>> result = scene.build().run(until=15)
>>> result["v"][-1], result.status
"""

from ._core import Equations, Model, Scene, __version__, methods
from ._errors import (
    DeriveError,
    Diagnostic,
    Error,
    Interrupted,
    RunError,
    RunWarning,
    SceneError,
    SolveError,
)
from ._result import Names, Result, State

__all__ = [
    "DeriveError",
    "Diagnostic",
    "Equations",
    "Error",
    "Interrupted",
    "Model",
    "Names",
    "Result",
    "RunError",
    "RunWarning",
    "Scene",
    "SceneError",
    "SolveError",
    "State",
    "__version__",
    "methods",
]
