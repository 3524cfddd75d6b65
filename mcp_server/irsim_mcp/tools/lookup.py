"""``lookup``: explain what scenarios may contain, and return templates to start from."""

from __future__ import annotations

from typing import Annotated

from mcp.types import TextContent
from pydantic import Field

from irsim_mcp.services import Services
from irsim_mcp.tool import StrictTool, strict

__all__ = ["PLACE", "tool"]

PLACE = 1

_DESCRIPTION = """
    Explain what scenario files may contain, and give templates to start from. Call it first with all topics you need
    (at most 12), separated by commas ('crowd, robot.fov, lidar2d'): each is answered briefly. Alone, a topic is
    answered in full: a template name returns a complete scenario as YAML, with `parameters` filled in; a key or path
    ('vel_max'), a component ('dash'), a code ('unknown-key'), a metric ('spl') or any word ('parking') returns meaning,
    unit, range, default and an example; a quantity ('12 ft') is converted. Next: edit the closest template and call
    run_episode with seeds=3.
"""


def tool(services: Services) -> StrictTool:
    """Make the tool."""
    most = services.limits.text

    async def lookup(
        topic: Annotated[str, Field(max_length=200, description="One or several; empty: index.")] = "",
        parameters: Annotated[
            dict[str, str | bool | int | float] | None,
            Field(description='Of a template, such as {"width": 1.4}; its answer lists them.'),
        ] = None,
    ) -> list[TextContent]:
        text = await services.reference("lookup", "topic", topic=topic, parameters=parameters)
        if len(text) > most:
            text = text[:most] + "\n… cut here: look up a more specific topic"
        return [TextContent(type="text", text=text)]

    return strict(
        lookup, title="Look up the language and templates", description=_DESCRIPTION, read_only=True, idempotent=True
    )
