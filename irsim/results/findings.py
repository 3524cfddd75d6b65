"""A diagnostic and the edit that repairs it, as typed results."""

from __future__ import annotations

from typing import Any, Literal

from irsim.results.base import Result

__all__ = ["Edit", "Finding"]


class Edit(Result):
    """A repair that a program can make without guessing."""

    action: Literal["remove", "replace", "rename", "add"]
    path: str
    """What to remove, replace or rename, or the key to add."""
    value: Any = None
    """The new value, or the new name of a key."""


class Finding(Result):
    """One diagnostic."""

    code: str
    """Name in the closed list of codes; ``irsim describe CODE`` explains it."""
    severity: Literal["error", "warning", "hint"]
    """``error``: will not run as asked; ``warning``: runs, but likely not what was meant; ``hint``: worth knowing."""
    path: str
    """Where in the document: ``robot[0].behavior.name``."""
    line: int | None
    """Line in the file, from 1."""
    column: int | None
    """Column in the line, from 1."""
    length: int = 1
    """Number of characters to underline, from that column on."""
    message: str
    """What is wrong."""
    given: Any = None
    """The value as written; a long one is cut and given as text."""
    allowed: list[str] | str | None = None
    """What would be accepted."""
    fix: str | None = None
    """What to write instead."""
    edit: Edit | None = None
    """The fix as an edit that a program can make without guessing, as ``irsim validate --fix`` does."""
    tolerated: bool = False
    """Whether ``irsim run`` continues in spite of it, as IR-SIM does."""
    in_base: bool | None = None
    """Whether the scenario compared with has it too; None without a comparison."""
