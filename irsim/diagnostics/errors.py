"""Exceptions of irsim. Everything a user can mend derives from :class:`IrsimError` and says what to change."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from irsim.diagnostics.diagnostic import Diagnostic

__all__ = [
    "ArgumentError",
    "BehaviorError",
    "IrsimError",
    "NotSimulatedError",
    "OverLimitError",
    "PlacementError",
    "ScenarioError",
    "ScenarioNotFoundError",
]


class IrsimError(Exception):
    """Base of all errors that irsim raises on purpose."""


class ScenarioError(IrsimError, ValueError):
    """A scenario that cannot be used, with every problem found.

    Attributes:
        diagnostics: All findings, errors first; warnings are included.
    """

    def __init__(self, diagnostics: Sequence[Diagnostic], source: str | None = None) -> None:
        from irsim.diagnostics.report import format_diagnostics

        self.diagnostics = list(diagnostics)
        self.source = source
        super().__init__("\n" + format_diagnostics(self.diagnostics, source))


class OverLimitError(IrsimError, ValueError):
    """More work is asked for than the limits allow.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        message: What is asked for and how much is allowed.
        fix: What to ask for instead.
    """

    code = "over-limit"

    def __init__(self, message: str, fix: str) -> None:
        self.message, self.fix = message, fix
        super().__init__(f"{self.code}: {message}. Fix: {fix}.")


class ArgumentError(IrsimError, ValueError):
    """Something was given to a function or a command that it cannot be.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        message: What is wrong.
        fix: What to give instead.
    """

    code = "bad-argument"

    def __init__(self, message: str, fix: str) -> None:
        self.message, self.fix = message, fix
        super().__init__(f"{self.code}: {message}. Fix: {fix}.")


class BehaviorError(IrsimError, ValueError):
    """A behavior written in Python raised an error or returned something that is no control.

    Attributes:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
    """

    code = "behavior-failed"


class NotSimulatedError(ScenarioError):
    """The scenario is valid but uses something this version does not simulate."""


class PlacementError(ScenarioError):
    """Random placement found no room for an object."""


class ScenarioNotFoundError(IrsimError, FileNotFoundError):
    """No scenario file of that name; the message names the places searched and near matches."""
