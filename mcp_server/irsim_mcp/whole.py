"""A result as the command and Python give it, whole."""

from __future__ import annotations

import json
from typing import Any

from mcp.types import TextContent

from irsim_mcp.errors import failure

__all__ = ["whole"]


def whole(found: dict[str, Any], room: int, elsewhere: str) -> TextContent:
    """The JSON that ``--json`` prints.

    Args:
        found: The result.
        room: Characters at most.
        elsewhere: What to do when it is longer.

    Raises:
        ToolError: It is longer.
    """
    text = json.dumps(found)
    if len(text) > room:
        what = f"the whole result has {len(text):,} characters; at most {room:,} are given"
        raise failure("over-limit", what, where="response_format", fix=elsewhere)
    return TextContent(type="text", text=text)
