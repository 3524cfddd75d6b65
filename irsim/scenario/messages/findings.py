"""Findings made while a scenario is read: a diagnostic, and how IR-SIM 2.12 would continue in spite of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from irsim.diagnostics.diagnostic import Diagnostic, Edit, Path

__all__ = ["Finding", "error", "hint", "key_path", "warning"]


@dataclass(frozen=True)
class Finding:
    """A diagnostic, and an edit with the effect of IR-SIM 2.12's own reaction, which is not the best repair."""

    diagnostic: Diagnostic
    carry_on: Edit | None = None

    @property
    def blocking(self) -> bool:
        """Whether a scenario with this finding cannot be used at all."""
        return self.diagnostic.severity == "error" and not self.diagnostic.tolerated


def key_path(path: Path) -> str:
    """A path without indices, robots and obstacles alike: ``entry.sensors.noise``."""
    words = [part for part in path if isinstance(part, str)]
    if words and words[0] in ("robot", "obstacle"):
        words[0] = "entry"
    return ".".join(words)


def error(
    code: str,
    path: Path,
    message: str,
    *,
    given: Any = None,
    allowed: Sequence[str] | str | None = None,
    fix: str | None = None,
    edit: Edit | None = None,
    tolerated: bool = False,
    carry_on: Edit | None = None,
) -> Finding:
    """An error. IR-SIM 2.12 tolerates it if ``carry_on`` (an edit with the same effect) or ``tolerated`` is given."""
    tolerated = tolerated or carry_on is not None
    diagnostic = Diagnostic(
        code, "error", path, message, given=given, allowed=allowed, fix=fix, edit=edit, tolerated=tolerated
    )
    return Finding(diagnostic, carry_on)


def warning(
    code: str,
    path: Path,
    message: str,
    *,
    given: Any = None,
    allowed: Sequence[str] | str | None = None,
    fix: str | None = None,
    edit: Edit | None = None,
) -> Finding:
    """A finding about a scenario that runs, but probably not as meant."""
    return Finding(Diagnostic(code, "warning", path, message, given=given, allowed=allowed, fix=fix, edit=edit))


def hint(
    code: str, path: Path, message: str, *, given: Any = None, fix: str | None = None, edit: Edit | None = None
) -> Finding:
    """A finding that is worth knowing and may need no change."""
    return Finding(Diagnostic(code, "hint", path, message, given=given, fix=fix, edit=edit))
