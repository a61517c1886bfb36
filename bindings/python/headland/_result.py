"""What a run gives."""

from __future__ import annotations

import difflib
import json
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from numpy.typing import NDArray


class State(NamedTuple):
    """A state; `equations.acceleration(*state)` evaluates at it."""

    t: float
    """Time, s."""
    q: NDArray[np.float64]
    """Coordinates."""
    u: NDArray[np.float64]
    """Quasi-velocities."""


class Names(NamedTuple):
    """Names of the states."""

    q: list[str]
    """Of the coordinates."""
    u: list[str]
    """Of the quasi-velocities; an independent rate bears the name of its coordinate and a prime."""


class Result:
    """Columns of a run over time; `result["v"]` is one of them."""

    t: NDArray[np.float64]
    """Times, s."""
    data: NDArray[np.float64]
    """One row a time, one column an output."""
    columns: list[str]
    """Names of the outputs."""
    units: list[str]
    """Their units."""
    summary: dict[str, Any]
    """Status, method and why, counts, times, energy balance, log, versions: what `summary.json` holds."""

    __slots__ = ("t", "data", "columns", "units", "summary")

    def __init__(
        self,
        t: NDArray[np.float64],
        data: NDArray[np.float64],
        columns: list[str],
        units: list[str],
        summary: str,
    ) -> None:
        self.t = t
        self.data = data
        self.columns = columns
        self.units = units
        self.summary = json.loads(summary)

    @property
    def status(self) -> str:
        """How the run ended: `done`, `stopped` by an event or a signal, or `failed`."""
        return self.summary["status"]

    @property
    def reason(self) -> str | None:
        """What stopped it or made it fail."""
        return self.summary.get("reason")

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """One column by name, a view; `"t"` is the time."""
        if name in self.columns:
            return self.data[:, self.columns.index(name)]
        if name == "t":
            return self.t
        near = difflib.get_close_matches(name, self.columns, 3)
        hint = f"; did you mean {' or '.join(map(repr, near))}?" if near else ""
        raise KeyError(f"no column {name!r}{hint}")

    def __contains__(self, name: object) -> bool:
        return name in self.columns or name == "t"

    def __len__(self) -> int:
        """Number of times."""
        return len(self.t)

    __iter__ = None  # by name, not by number

    def to_pandas(self) -> pd.DataFrame:
        """A data frame with the times as index; the units are in its `attrs["units"]`. Needs pandas."""
        import pandas as pd

        frame = pd.DataFrame(self.data, index=pd.Index(self.t, name="t"), columns=self.columns)
        frame.attrs["units"] = dict(zip(self.columns, self.units))
        return frame

    def __repr__(self) -> str:
        end = f"{self.status} at t = {self.summary['t_end']:g} s"
        return f"<headland.Result: {len(self.t)} times, {len(self.columns)} columns, {end}>"
