"""``write_scenario``: save a scenario as a file of the workspace; offered only with ``--enable-write``."""

from __future__ import annotations

from typing import Annotated, Any

import anyio.to_thread
from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field

from irsim.common.text import clean, plural
from irsim_mcp.services import Services
from irsim_mcp.tool import StrictTool, strict

__all__ = ["PLACE", "WRITES", "Written", "tool"]

PLACE = 8
WRITES = True

_DESCRIPTION = """
    Save a scenario as a file of the workspace. It is validated first: one with errors is not written. An existing file
    is kept unless overwrite=true. Only .yaml and .yml files in folders whose names start with no dot; missing folders
    are created. Next: use the path as scenario_path.
"""


class Written(BaseModel):
    """The written file."""

    model_config = ConfigDict(extra="forbid")

    path: str
    bytes: int
    replaced: bool
    summary: str
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def write_scenario(
        path: Annotated[str, Field(max_length=300, description="Relative to the workspace, such as rooms/a.yaml.")],
        yaml: Annotated[str, Field(description="The whole scenario (at most 256 KiB).")],
        overwrite: bool = False,
    ) -> Annotated[CallToolResult, Written]:
        where = services.workspace.new_file(path)
        checked = await services.text_job(
            "validate_new", yaml, "yaml", path=where, seconds=services.limits.check_seconds
        )
        data = yaml.encode()
        replaced = await anyio.to_thread.run_sync(services.workspace.write, where, data, overwrite)
        summary = f"{'replaced' if replaced else 'wrote'} {clean(where)} ({len(data):,} bytes): {_contents(checked)}"
        advice = f"Look and run: run_episode scenario_path={clean(where)} seeds=3."
        report = Written(path=where, bytes=len(data), replaced=replaced, summary=summary, next=advice)
        text = TextContent(type="text", text=f"{summary}\nNext: {advice}")
        return CallToolResult(content=[text], structured_content=report.model_dump())

    return strict(
        write_scenario,
        title="Save a scenario",
        description=_DESCRIPTION,
        read_only=False,
        idempotent=True,
        destructive=True,
    )


def _contents(checked: dict[str, Any]) -> str:
    warnings = checked["warnings"]
    return f"{checked['contents']}, {plural(warnings, 'warning') if warnings else 'no warnings'}"
