"""The complete JSON of a result, as the command line prints it with ``--json``."""

from __future__ import annotations

from typing import Any

from mcp.types import TextContent

from irsim_mcp.errors import failure

__all__ = ["Found", "json_answer"]


class Found(dict[str, Any]):
    """The result of a worker, and the JSON text in which it was written."""

    text: str = ""


def json_answer(found: Found, most: int, alternative: str, *, prefix: str = "") -> TextContent:
    """The complete result as JSON.

    Args:
        found: The result.
        most: Greatest number of characters.
        alternative: What to do if the JSON is longer.
        prefix: Beginning of the message if the JSON is longer.

    Raises:
        ToolError: The JSON is longer.
    """
    text = found.text
    if len(text) > most:
        what = f"{prefix}the whole result has {len(text):,} characters; at most {most:,} are returned"
        raise failure("over-limit", what, where="response_format", fix=alternative)
    return TextContent(type="text", text=text)
