"""What can go wrong: one class a stage, from scene to run."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from ._result import Result


class Diagnostic(NamedTuple):
    """One thing that is wrong with a scene, or worth a warning, and where."""

    file: str
    """Name of the file, or that given to `Scene.parse`."""
    line: int | None
    """Line, counted from 1; `None` if the file is not to blame."""
    column: int | None
    """Column, counted from 1 in characters."""
    message: str
    """What is wrong, what was found, what would be right."""
    setting: str | None = None
    """`NAME=VALUE` where a setting is to blame."""


class Error(Exception):
    """Base of all errors of headland."""


class SceneError(Error):
    """The scene is wrong; all that is wrong with it at once."""

    diagnostics: list[Diagnostic]
    """What is wrong, in the order of the file."""

    def __init__(self, message: str, diagnostics: list[Diagnostic] | None = None) -> None:
        super().__init__(message)
        self.diagnostics = list(diagnostics or [])


class DeriveError(Error):
    """The model has no equations of motion."""

    diagnostic: Diagnostic | None
    """The place in the scene, where there is one."""

    def __init__(self, message: str, diagnostic: Diagnostic | None = None) -> None:
        super().__init__(message)
        self.diagnostic = diagnostic


class SolveError(Error):
    """No integrator can do what was asked: no such method, a tolerance out of range."""


class RunError(Error):
    """A run failed on the way, or could not start."""

    result: Result | None
    """What was computed until it failed; `None` if it could not start."""

    def __init__(self, message: str, result: Result | None = None) -> None:
        super().__init__(message)
        self.result = result


class Interrupted(KeyboardInterrupt):
    """A run was interrupted from the keyboard."""

    result: Result
    """What was computed until then; its status is `stopped`."""

    def __init__(self, message: str, result: Result | None = None) -> None:
        super().__init__(message)
        if result is not None:  # as always but where a process unpickles it: then it follows
            self.result = result


class RunWarning(UserWarning):
    """Something in a run deserves attention; it is in `result.summary["log"]`, too."""
