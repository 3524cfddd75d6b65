"""``export_run``: a recorded run as a file of another program in the workspace; only with ``--enable-write``."""

from __future__ import annotations

from typing import Annotated, Any

from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field

from irsim.common.text import clean
from irsim_mcp.services import RunId, Services
from irsim_mcp.tool import StrictTool, strict

__all__ = ["PLACE", "WRITES", "Exported", "tool"]

PLACE = 9
WRITES = True

_DESCRIPTION = """
    Write a recorded run as a file of another program to the folder exports of the workspace: a table (csv, npz), ROS
    (mcap), a scene of another simulator (usd, mjcf, sdf), and more. A format that does not exist is answered by the
    list of formats; some need a library, which the answer names. Nothing is sent anywhere. Next: tell the path.
"""


class Exported(BaseModel):
    """The written file."""

    model_config = ConfigDict(extra="forbid")

    path: str
    bytes: int
    format: str
    steps: int
    objects: list[str]
    notes: list[str]
    summary: str
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def export_run(
        run_id: RunId,
        to: Annotated[str, Field(max_length=40, description="Format, such as csv, usd or mcap.")],
        objects: Annotated[
            str, Field(max_length=2000, description="movers, robots, all, or names with commas.")
        ] = "movers",
    ) -> Annotated[CallToolResult, Exported]:
        services.workspace.check_run(run_id)
        exported = await services.run_job(
            "export",
            run_id,
            seconds=services.limits.draw_seconds,
            to=to,
            objects=objects,
            out=services.workspace.folder_for_exports(),
        )
        report = _report(exported)
        lines = [report.summary, *(f"Note: {note}" for note in report.notes), f"Next: {report.next}"]
        text = TextContent(type="text", text="\n".join(lines))
        return CallToolResult(content=[text], structured_content=report.model_dump())

    return strict(export_run, title="Export a run", description=_DESCRIPTION, read_only=False, idempotent=True)


def _report(exported: dict[str, Any]) -> Exported:
    path = clean(str(exported["file"]), 300)
    objects = [clean(name, 60) for name in exported["objects"]]
    summary = f"wrote {path} ({exported['bytes']:,} bytes): {len(objects)} objects, {exported['steps']} steps"
    return Exported(
        path=path,
        bytes=exported["bytes"],
        format=exported["format"],
        steps=exported["steps"],
        objects=objects[:50],
        notes=[clean(note, 300) for note in exported["notes"]],
        summary=summary,
        next="tell the user the path; the same call with another format writes another file.",
    )
