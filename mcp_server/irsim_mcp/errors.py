"""Errors of tools: one line that says what is wrong, where, and how to fix it."""

from __future__ import annotations

from mcp.server.mcpserver.exceptions import ToolError

from irsim.common.text import clean
from irsim.diagnostics.codes import CODES, TOOL_CODES

__all__ = ["failure"]

_MAX_LENGTH = 400
"""Number of characters of an error."""


def failure(code: str, what: str, *, where: str | None = None, fix: str | None = None) -> ToolError:
    """An error to raise: ``code: what (where). Fix: …``, at most 400 characters.

    Args:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        what: What is wrong; shortened if the line gets too long.
        where: The argument or path that is wrong.
        fix: What to change.
    """
    if code not in CODES and code not in TOOL_CODES:
        raise LookupError(f"undocumented error code {code!r}: add it to irsim/diagnostics/codes/")
    place = f" ({clean(where)})" if where else ""
    remedy = f" Fix: {_sentence(fix)}" if fix else ""
    left = _MAX_LENGTH - len(f"{code}: {place}.{remedy}")
    return ToolError(clean(f"{code}: {clean(_one_line(what), max(40, left))}{place}.{remedy}", _MAX_LENGTH))


def _one_line(text: str) -> str:
    return " ".join(text.split()).rstrip(".")


def _sentence(text: str) -> str:
    line = _one_line(text)
    return line if line.endswith(("?", "!")) else f"{line}."
