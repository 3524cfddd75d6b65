"""A result as the command and Python give it, whole."""

from __future__ import annotations

from typing import Any

from mcp.types import TextContent

from irsim_mcp.errors import failure

__all__ = ["Found", "whole"]


class Found(dict[str, Any]):
    """A result of a worker, and its text as that wrote it."""

    text: str = ""


def whole(found: Found, room: int, elsewhere: str, *, about: str = "") -> TextContent:
    """The JSON that ``--json`` prints.

    Args:
        found: The result.
        room: Characters at most.
        elsewhere: What to do when it is longer.
        about: What to say first then.

    Raises:
        ToolError: It is longer.
    """
    text = found.text
    if len(text) > room:
        what = f"{about}the whole result has {len(text):,} characters; at most {room:,} are given"
        raise failure("over-limit", what, where="response_format", fix=elsewhere)
    return TextContent(type="text", text=text)
