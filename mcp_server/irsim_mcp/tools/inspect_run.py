"""``inspect_run``: tables of a recorded run, so that a model need not read all of it."""

from __future__ import annotations

import itertools
import json
from contextlib import nullcontext
from typing import Annotated, Any, Literal

from mcp.types import CallToolResult, TextContent
from pydantic import BaseModel, ConfigDict, Field, WithJsonSchema

from irsim.common.text import clean
from irsim_mcp.answers import failure
from irsim_mcp.jobs import readable
from irsim_mcp.services import RunId, Services
from irsim_mcp.suites import check_finished, episodes_table
from irsim_mcp.tool import StrictTool, strict

__all__ = ["PLACE", "Table", "tool"]

PLACE = 5

_DESCRIPTION = """
    Why did a run fail? view=collisions: which objects touched, where, how fast; closest: closest approaches of each
    robot, edge to edge; speeds: path, extreme speeds (forward <0: backwards), turn rates, longest stop; zones: who
    entered or crossed what; sight: who saw whom; rows: `fields` step by step, spread over the run unless `every` is
    given. Of a benchmark: its episodes. Returns pages (next_cursor). Next: draw the moment with
    render_snapshot run_id step.
"""
_MAX_CELL_LENGTH = 60
"""Number of characters of a cell."""
_MAX_EPISODE_CELL_LENGTH = 300
"""Number of characters of a cell in a table of episodes."""
_RESERVED_LENGTH = 2000
"""Number of characters that are reserved for a result besides its rows."""


Cell = Annotated[float | int | str | bool | None, WithJsonSchema({"type": ["number", "string", "boolean", "null"]})]


Column = Literal[
    "x", "y", "heading", "speed", "turn_rate", "control", "goal", "goal_distance", "nearest_hit", "status", "readings"
]  # fmt: skip


class Table(BaseModel):
    """Table of a run: lengths in m, times in s, angles in rad."""

    model_config = ConfigDict(extra="allow")  # the further keys of `irsim inspect --json`

    summary: str
    columns: list[str]
    rows: list[list[Cell]]
    total: int
    next: str


def tool(services: Services) -> StrictTool:
    """Make the tool."""

    async def inspect_run(
        run_id: RunId,
        view: Literal["rows", "collisions", "closest", "speeds", "zones", "sight"] = "rows",
        robot: Annotated[str | None, Field(description="Names, a tag, all or obstacles; default: robots.")] = None,
        from_step: Annotated[int, Field(ge=0)] = 0,
        to_step: Annotated[int | None, Field(ge=0)] = None,
        every: Annotated[int | None, Field(ge=1)] = None,
        fields: list[Column] | None = None,
        limit: Annotated[int, Field(ge=1, le=200)] = 20,
        cursor: str | None = None,
    ) -> Annotated[CallToolResult, Table]:  # fmt: skip
        asked: dict[str, Any] = {"robot": robot, "to_step": to_step, "every": every, "fields": fields}
        job = None if run_id in services.workspace.runs() else await services.jobs.state(run_id)
        data: dict[str, Any]
        if job is not None:
            used = [name for name, value in {**asked, "from_step": from_step or None}.items() if value is not None]
            data = _episodes(services, job, ["view"] * (view != "rows") + used, limit, cursor)
        else:
            data = await services.run_job(
                "inspect",
                run_id,
                seconds=services.limits.check_seconds,
                view=view,
                from_step=from_step,
                limit=limit,
                cursor=cursor,
                **asked,
            )
        data = _first_rows(data, cursor, services.limits.text)
        with readable(job["id"]) if job is not None else nullcontext():
            table = _table(data, data["view"])
        text = TextContent(type="text", text=_text(table, data))
        return CallToolResult(content=[text], structured_content=table.model_dump())

    return strict(inspect_run, title="Look into a run", description=_DESCRIPTION, read_only=True, idempotent=True)


def _episodes(
    services: Services, job: dict[str, Any], other: list[str], limit: int, cursor: str | None
) -> dict[str, Any]:
    """The episodes of a benchmark.

    Args:
        services: The services.
        job: State of its job.
        other: Names of given arguments that apply only to runs.
        limit: Greatest number of rows.
        cursor: ``next_cursor`` of the previous page.

    Raises:
        ToolError: The job has no result, or an argument applies only to runs.
    """
    if other:
        what = f"{job['id']} is a benchmark, whose rows are episodes"
        fix = "leave it out; run_episode with the seed of an episode gives a run to look into"
        raise failure("bad-argument", what, where=other[0], fix=fix)
    check_finished(job)
    with readable(job["id"]):
        return episodes_table(job, limit, cursor, services.is_there)


def _first_rows(data: dict[str, Any], cursor: str | None, most_characters: int) -> dict[str, Any]:
    """The table with its first rows, as many as fit into a number of characters; the others are another page."""
    sizes = itertools.accumulate(len(json.dumps(row)) + 2 for row in data["rows"])
    kept = sum(size <= most_characters - _RESERVED_LENGTH for size in sizes)
    if kept == len(data["rows"]):
        return data
    return {**data, "rows": data["rows"][:kept], "next_cursor": str(int(cursor or 0) + kept)}


def _table(data: dict[str, Any], view: str) -> Table:
    longest = _MAX_CELL_LENGTH if view != "episodes" else _MAX_EPISODE_CELL_LENGTH
    rows = [[clean(cell, longest) if isinstance(cell, str) else cell for cell in row] for row in data["rows"]]
    changed = {"summary": clean(data["summary"], 300), "rows": rows, "next": _advice(data, view, rows)}
    return Table(**{key: value for key, value in {**data, **changed}.items() if key != "again"})


def _advice(data: dict[str, Any], view: str, rows: list[list[Any]]) -> str:
    more = "" if data["next_cursor"] is None else f"More rows: the same call with cursor={data['next_cursor']}."
    if view == "episodes":
        return f"Look into one: {data['again']}, then inspect_run with the returned run_id. {more}".rstrip()
    if more:
        return more
    if "step" in data["columns"] and rows and view != "rows":
        step = rows[0][data["columns"].index("step")]
        return f"Look at it: render_snapshot run_id={data['run_id']} step={step}."
    if view == "rows" and data["every"] > 1:
        return "Look closer with from_step, to_step, robot and every=1, or try view=collisions, closest, speeds."
    return f"Look at a moment with render_snapshot run_id={data['run_id']} step=N, then change the scenario."


def _text(table: Table, data: dict[str, Any]) -> str:
    """The table in words, with everything that the structured content has."""
    ended = data["status"] if data["outcome"] is None else data["outcome"]
    lines = [f"{ended}: {table.summary}", *(f"Note: {note}" for note in data["notes"]), ", ".join(table.columns)]
    lines += [", ".join("-" if cell is None else str(cell) for cell in row) for row in table.rows]
    spread = f", every {data['every']} steps" if data["every"] > 1 else ""
    return "\n".join([*lines, f"{len(table.rows)} of {table.total} rows{spread}", f"Next: {table.next}"])
