"""Answers of tools: an error in one line, or the complete JSON of a result."""

from __future__ import annotations

from typing import Any

from mcp.server.mcpserver.exceptions import ToolError
from mcp.types import TextContent

from irsim.common.text import clean
from irsim.diagnostics.codes import CODES, TOOL_CODES

__all__ = ["WorkerResult", "failure", "json_answer"]


_MAX_LENGTH = 400
"""Number of characters of an error."""


def failure(code: str, what: str, *, where: str | None = None, fix: str | None = None) -> ToolError:
    """An error to raise: ``code: what (where). Fix: …``, at most 400 characters.

    Args:
        code: Code of the closed list in :mod:`irsim.diagnostics.codes`.
        what: The problem; shortened if the line gets too long.
        where: The argument or path that is wrong.
        fix: The change that helps.
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


class WorkerResult(dict[str, Any]):
    """The result of a worker, and the JSON text in which it was written."""

    text: str = ""


def json_answer(result: WorkerResult, most: int, alternative: str, *, prefix: str = "") -> TextContent:
    """The complete result as JSON.

    Args:
        result: The result of the worker.
        most: Greatest number of characters.
        alternative: Advice if the JSON is longer.
        prefix: Beginning of the message if the JSON is longer.

    Raises:
        ToolError: The JSON is longer.
    """
    text = result.text
    if len(text) > most:
        what = f"{prefix}the whole result has {len(text):,} characters; at most {most:,} are returned"
        raise failure("over-limit", what, where="response_format", fix=alternative)
    return TextContent(type="text", text=text)
