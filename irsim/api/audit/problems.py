"""Collects what is wrong with a submission, and the comparisons that its audit has left out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from irsim.common.text import clean
from irsim.results.findings import Finding

__all__ = ["Problems", "flat", "is_close"]

_MAX_LISTED = 50
_AGAIN = "write the submission again: irsim benchmark SUITE --submission DIR"


class Problems:
    """The problems of a submission.

    Attributes:
        listed: The first problems.
        count: Number of problems.
        notes: Comparisons that were left out, in words.
    """

    def __init__(self) -> None:
        self.listed = list[Finding]()
        self.count = 0
        self.notes = list[str]()

    def add(
        self, code: str, path: str, message: str, *, given: Any = None, allowed: Any = None, fix: str = _AGAIN
    ) -> None:
        """Add a problem with a file.

        Args:
            code: The code.
            path: The file.
            message: The problem.
            given: The value in the file.
            allowed: The value that the audit has computed.
            fix: The remedy.
        """
        self.count += 1
        if len(self.listed) < _MAX_LISTED:
            shown = [None if value is None else clean(str(value), 200) for value in (given, allowed)]
            self.listed.append(
                Finding(code=code, severity="error", path=clean(path, 200), line=None, column=None,
                        message=clean(message, 400), given=shown[0], allowed=shown[1], fix=fix)
            )  # fmt: skip

    def note(self, text: str) -> None:
        """Say once that a comparison was left out."""
        if (cleaned := clean(text, 400)) not in self.notes:
            self.notes.append(cleaned)


def is_close(given: Any, known: Any, tolerance: float) -> bool:
    """Whether two values of plain data are equal, numbers up to an absolute and relative tolerance."""
    if isinstance(given, dict) and isinstance(known, dict):
        return given.keys() == known.keys() and all(is_close(given[key], known[key], tolerance) for key in given)
    if isinstance(given, (list, tuple)) and isinstance(known, (list, tuple)):
        return len(given) == len(known) and all(is_close(a, b, tolerance) for a, b in zip(given, known, strict=True))
    if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in (given, known)):
        return type(given) is type(known) and bool(given == known)
    return bool(given == known or abs(given - known) <= tolerance * max(1.0, abs(given), abs(known)))


def flat(data: Mapping[str, Any]) -> dict[str, Any]:
    """The values of a row; a value within a mapping has the names of both, joined."""
    values = dict[str, Any]()
    for key, value in data.items():
        values |= {f"{key} {name}": one for name, one in value.items()} if isinstance(value, dict) else {key: value}
    return values
