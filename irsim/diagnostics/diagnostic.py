"""Findings about a scenario, as data: one :class:`Diagnostic` per problem, codes from one closed list."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, TypeVar

from irsim.diagnostics.codes import CODES, TOOL_CODES

__all__ = [
    "SLIP_SIMILARITY",
    "Action",
    "Diagnostic",
    "Edit",
    "Path",
    "Severity",
    "format_path",
    "is_slip_of",
    "nearest",
    "suggestion",
]

Otherwise = TypeVar("Otherwise", str, None)

Severity = Literal["error", "warning", "hint"]
Path = tuple[str | int, ...]
Action = Literal["remove", "replace", "rename", "add", "insert", "delete", "duplicate"]
_ORDER = {"error": 0, "warning": 1, "hint": 2}
SLIP_SIMILARITY = 0.75
"""Similarity from which a word is a slip of another, 1 for equal words."""


@dataclass(frozen=True)
class Edit:
    """A machine-applicable repair: what to do with the node at ``path``.

    ``insert``, ``delete`` and ``duplicate`` move the later items of a list; ``insert`` at its length appends, and makes
    a list of a single value or of nothing. ``remove`` moves none. ``safe`` means that the author surely meant this.
    Otherwise it is one of several repairs, and the author chooses.
    """

    action: Action
    path: Path
    value: Any = None
    safe: bool = True


@dataclass(frozen=True)
class Diagnostic:
    """One finding.

    Attributes:
        code: Kebab-case name from :mod:`irsim.diagnostics.codes`.
        severity: ``error`` (will not run as asked), ``warning`` (runs, but likely not what was meant), ``hint``.
        path: Where in the document, e.g. ``("robot", 0, "behavior", "name")``.
        message: One sentence, without the location.
        line, column: Position of the node in the text, counted from 1; None when the source has no text.
        length: Characters to underline.
        given: The offending value, as written.
        allowed: Accepted values: names, a range, a type.
        fix: The text to write instead, in words that a person or agent can act on.
        edit: The best repair as a machine-applicable edit, if there is one.
        tolerated: Whether IR-SIM 2.12 continues in spite of this error. ``irsim.make`` and ``irsim run`` then do what
            it does (such as ignoring the key that ``edit`` would rename) and show a warning, unless asked to be strict.
        file: Name of the document.
    """

    code: str
    severity: Severity
    path: Path
    message: str
    line: int | None = None
    column: int | None = None
    length: int = 1
    given: Any = None
    allowed: Sequence[str] | str | None = None
    fix: str | None = None
    edit: Edit | None = None
    tolerated: bool = False
    file: str | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if self.code not in CODES and self.code not in TOOL_CODES:
            raise ValueError(f"undocumented diagnostic code {self.code!r}: add it to irsim/diagnostics/codes/")

    def as_dict(self) -> dict[str, Any]:
        """Plain data for JSON: stable keys, path as text."""
        data = asdict(self)
        data["path"] = format_path(self.path)
        if self.edit is not None:
            data["edit"] = {"action": self.edit.action, "path": format_path(self.edit.path), "value": self.edit.value}
        return data


def format_path(path: Path) -> str:
    """``("robot", 0, "shape")`` as ``robot[0].shape``; the document itself is ``(document)``."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else str(part)
    return text or "(document)"


def nearest(word: object, choices: Iterable[str], cutoff: float = 0.6) -> str | None:
    """The choice most similar to ``word``; None if none is similar enough.

    A choice that has all words of ``word``, which has several, in whatever order is nearer than one of similar letters:
    ``swap_circle`` means ``circle-swap``, and the last one of several. Of names that differ from ``word`` in numbers
    only, the one with the nearest numbers is the nearest.
    """
    lowered = {str(choice).lower(): str(choice) for choice in choices}
    text, asked = str(word).lower(), _words(str(word))
    same = [choice for choice in lowered if asked <= _words(choice)] if len(asked) > 1 and text not in lowered else []
    matches = same or difflib.get_close_matches(text, list(lowered), max(1, len(lowered)), cutoff)
    alike = [choice for choice in matches if _NUMBER.sub("0", choice) == _NUMBER.sub("0", text)]
    if alike:
        return lowered[min(alike, key=lambda choice: _distance(text, choice))]
    if same:
        return lowered[min(reversed(same), key=lambda choice: len(_words(choice)))]
    return lowered[matches[0]] if matches else None


_NUMBER = re.compile(r"\d+(?:\.\d+)?")


def _distance(one: str, other: str) -> float:
    """How far apart the numbers of two names are that have the same words."""
    pairs = zip(_NUMBER.findall(one), _NUMBER.findall(other), strict=True)
    return sum(abs(float(mine) - float(yours)) for mine, yours in pairs)


def _words(name: str) -> set[str]:
    return set(re.findall("[a-z][a-z0-9]*", name.lower()))


def suggestion(word: object, choices: Iterable[str], otherwise: Otherwise) -> str | Otherwise:
    """Return a fix that names the choice most similar to ``word``, or ``otherwise`` if none is similar enough."""
    near = nearest(word, choices)
    return f"did you mean {near}?" if near else otherwise


def is_slip_of(word: object, meant: str) -> bool:
    """Whether ``word`` is ``meant`` with a letter or two wrong, so that it can hardly mean anything else."""
    return nearest(word, [meant], SLIP_SIMILARITY) is not None


def by_severity(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Errors first, then warnings, then hints; each in document order."""
    return sorted(diagnostics, key=lambda d: (_ORDER[d.severity], d.line or 0, d.column or 0))
