"""Errors of tools: one line that says what is wrong, where, and what to do about it."""

from __future__ import annotations

from mcp.server.mcpserver.exceptions import ToolError

from irsim.common.text import clean
from irsim.diagnostics.codes import CODES, TOOL_CODES

__all__ = ["failure"]

_LONGEST = 400


def failure(code: str, what: str, *, where: str | None = None, fix: str | None = None) -> ToolError:
    """An error to raise: ``code: what (where). Fix: …``, at most 400 characters.

    Args:
        code: Name in the closed list of :mod:`irsim.diagnostics.codes`.
        what: What is wrong; cut if the line gets too long.
        where: Argument or path it is about.
        fix: What to change.
    """
    if code not in CODES and code not in TOOL_CODES:
        raise LookupError(f"undocumented error code {code!r}: add it to irsim/diagnostics/codes/")
    place = f" ({clean(where)})" if where else ""
    remedy = f" Fix: {_sentence(fix)}" if fix else ""
    room = _LONGEST - len(f"{code}: {place}.{remedy}")
    return ToolError(clean(f"{code}: {clean(_one_line(what), max(40, room))}{place}.{remedy}", _LONGEST))


def _one_line(text: str) -> str:
    return " ".join(text.split()).rstrip(".")


def _sentence(text: str) -> str:
    line = _one_line(text)
    return line if line.endswith(("?", "!")) else f"{line}."
