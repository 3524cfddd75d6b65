"""A diagnostic and the edit that repairs it, as typed results."""

from __future__ import annotations

import json
from typing import Any, Literal

from irsim.common.text import clean
from irsim.diagnostics import diagnostic as diagnostics
from irsim.diagnostics.diagnostic import Action, Diagnostic, format_path
from irsim.results.base import Result

__all__ = ["Edit", "Finding"]

_MAX_GIVEN_LENGTH = 200
"""Number of characters of the JSON of a wrong value that a finding keeps."""


class Edit(Result):
    """A repair that a program can make without guessing."""

    action: Action
    path: str
    """The key or value to remove, replace or rename, or the key to add."""
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
    """The problem, in a sentence."""
    given: Any = None
    """The value as written; a long one is cut and given as text."""
    allowed: list[str] | str | None = None
    """Values that would be accepted."""
    fix: str | None = None
    """The text to write instead."""
    edit: Edit | None = None
    """The fix as an edit that a program can make without guessing, as ``irsim validate --fix`` does."""
    tolerated: bool = False
    """Whether ``irsim run`` continues in spite of it, as IR-SIM does."""
    in_base: bool | None = None
    """Whether the scenario compared with has it too; None without a comparison."""

    @classmethod
    def of(cls, diagnostic: Diagnostic) -> Finding:
        """The finding of a diagnostic."""
        allowed = diagnostic.allowed
        return cls(
            code=diagnostic.code,
            severity=diagnostic.severity,
            path=format_path(diagnostic.path),
            line=diagnostic.line,
            column=diagnostic.column,
            length=diagnostic.length,
            message=diagnostic.message,
            given=_short(diagnostic.given),
            allowed=allowed if allowed is None or isinstance(allowed, str) else list(allowed),
            fix=diagnostic.fix,
            edit=_edit(diagnostic.edit),
            tolerated=diagnostic.tolerated,
        )


def _short(given: Any) -> Any:
    """A value as written, or the beginning of its JSON if that is long."""
    try:
        text = json.dumps(given, default=str)
    except (ValueError, RecursionError):  # the value contains itself
        return clean(type(given).__name__)
    return given if len(text) <= _MAX_GIVEN_LENGTH else clean(text, _MAX_GIVEN_LENGTH)


def _edit(edit: diagnostics.Edit | None) -> Edit | None:
    """The edit of a finding; None for an edit that could change what the scenario means."""
    if edit is None or not edit.safe:
        return None
    return Edit(action=edit.action, path=format_path(edit.path), value=edit.value)
