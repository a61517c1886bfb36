"""The compiled part of headland."""

import os
from collections.abc import Iterable, Sequence
from typing import Any, Literal, SupportsFloat, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._errors import Diagnostic
from ._result import Names, Result, State

__all__ = ["Equations", "Model", "Scene", "__version__", "methods"]

__version__: str
methods: list[str]
"""Names of the integrators in this build."""

_Value = Union[SupportsFloat, str, bool, Sequence["_Value"], NDArray[Any]]

@final
class Scene:
    """What a scene file says; the format is described in docs/scene-format.md."""

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Scene:
        """Read a scene file.

        Raises `OSError` if there is none, `SceneError` if it is no scene.
        """
    @staticmethod
    def parse(text: str, name: str = "scene") -> Scene:
        """Read a scene from a text; `name` stands for the file in messages."""
    def set(self, name: str, value: _Value) -> None:
        """Change a value, as `--set NAME=VALUE` does: a number, a quantity, an expression, an array.

        A name is looked for among parameters, prescribed coordinates, definitions, initial values and indices;
        `l[2]` is a member of an array, `run.until` an entry of a section, `pull.value` the key of an element.
        A bare number keeps the unit that the value had. Raises `SceneError` if there is no such name.
        """
    def __setitem__(self, name: str, value: _Value, /) -> None:
        """`scene["v0"] = "18 m/s"`: as `set`."""
    def __getitem__(self, name: str, /) -> Any:
        """The value as it is written now: a number, a text, a list. Raises `KeyError`."""
    def build(self) -> Model:
        """Make a model: names, units, families, dimensions are checked, all errors told in one `SceneError`."""
    def copy(self) -> Scene:
        """A copy that can be changed without changing this one."""
    def __copy__(self) -> Scene: ...
    def __deepcopy__(self, _memo: Any) -> Scene: ...
    @property
    def title(self) -> str:
        """The title."""
    @property
    def name(self) -> str:
        """The name of the file, or that given to `parse`."""

@final
class Model:
    """A checked scene, ready to run. It is never changed: many threads may run it at once."""

    def run(
        self,
        *,
        until: float | None = None,
        tolerance: float | None = None,
        at: float | Iterable[float] | None = None,
        method: str | None = None,
        points: int | None = None,
        max_step: float | None = None,
        balance: bool = True,
    ) -> Result:
        """Derive, compile, integrate. What is not given is as the scene says.

        until      end, s; with `at` alone, the last of its times
        tolerance  relative; of each state times its scale the absolute one
        at         output at exactly these times, s (given in order, each once), at which steps end
        method     auto, dop853, cvode-bdf, cvode-adams
        points     output intervals, if there is no `at`
        max_step   longest step, s
        balance    whether the account of work and energy is kept

        The interpreter is let go while it runs. Warnings are issued as `RunWarning`.

        Raises `DeriveError`, `SolveError` or `RunError` if it cannot start; `RunError` with `.result` if it fails on
        the way; `Interrupted`, a `KeyboardInterrupt` with `.result`, if it is interrupted.
        """
    def equations(self, algorithm: Literal["cheaper", "direct", "combine"] = "cheaper") -> Equations:
        """Derive the equations of motion, with the independent rates that suit the start."""
    @property
    def title(self) -> str:
        """The title of the scene."""
    @property
    def coordinates(self) -> list[str]:
        """Names of the coordinates; the prescribed ones are no states and are left out."""
    @property
    def parameters(self) -> dict[str, float]:
        """Parameters with their values in SI units."""
    @property
    def columns(self) -> list[str]:
        """Names of the columns that a run gives."""
    @property
    def warnings(self) -> list[Diagnostic]:
        """What deserves attention but is not wrong."""

@final
class Equations:
    """`q' = G u + g`, `M u' = F`, compiled. All in SI units.

    `t` is a number, `q` and `u` are vectors in the order of `names`; or any of them has an axis of points in front,
    and so has the result. Threads may share it.
    """

    def mass(self, t: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]:
        """Mass matrix M: `[nu, nu]`."""
    def force(self, t: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]:
        """Right-hand side F of `M u' = F`: `[nu]`."""
    def acceleration(self, t: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]:
        """`u'`: `[nu]`."""
    def rates(self, t: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]:
        """Rates of the coordinates, `q' = G u + g`: `[nq]`."""
    def jacobian(self, t: ArrayLike, q: ArrayLike, u: ArrayLike) -> NDArray[np.float64]:
        """Exact Jacobian `d[q', u']/d[q, u]`: `[nq + nu, nq + nu]`."""
    def text(self, form: Literal["text", "latex", "c"] = "text") -> str:
        """The equations as text, LaTeX or C."""
    @property
    def state0(self) -> State:
        """The start of the scene. Raises `DeriveError` if the initial rates do not determine it."""
    @property
    def names(self) -> Names:
        """Names of the states: coordinates q, quasi-velocities u."""
    @property
    def algorithm(self) -> str:
        """The algorithm that was kept: `direct` or `combine`."""
    @property
    def why(self) -> str:
        """Why that one."""
    @property
    def freedom(self) -> str:
        """Degrees of freedom in a sentence."""
