"""Recorded runs as resources: ``irsim://runs/{run_id}/{artifact}``, at most 1 MB per read. Tools work without them."""

from __future__ import annotations

import re
from pathlib import PurePosixPath

from mcp.server import MCPServer
from mcp.server.mcpserver.exceptions import ResourceNotFoundError, ToolError

from irsim.common.text import clean
from irsim.runs.store import ARTIFACTS
from irsim_mcp.errors import failure
from irsim_mcp.services import Services

__all__ = ["RUN", "add_run_resources", "media_type", "uri"]

RUN = "irsim://runs/{run_id}/{artifact}{?from_step,to_step,every,robot,offset}"
_MAX_BYTES = 1_000_000
"""Size of the largest part of a run that one read returns."""
_TYPES = {".json": "application/json", ".csv": "text/csv", ".yaml": "application/yaml"}


def media_type(uri: str) -> str | None:
    """Media type of a part of a run; None for other resources. A part from the middle of a file is plain text."""
    path, _, query = uri.partition("?")
    if not path.startswith("irsim://runs/"):
        return None
    middle = re.search(r"(^|&)offset=0*[1-9]", query) and not path.endswith("/replay.json")
    return "text/plain" if middle else _TYPES.get(PurePosixPath(path).suffix, "text/plain")


def uri(run_id: str, artifact: str) -> str:
    """URI of an artifact of a run."""
    return f"irsim://runs/{run_id}/{artifact}"


def add_run_resources(server: MCPServer, services: Services) -> None:
    """Register the resource template with a server."""

    async def run_artifact(
        run_id: str,
        artifact: str,
        from_step: str = "0",
        to_step: str | None = None,
        every: str = "1",
        robot: str | None = None,
        offset: str = "0",
    ) -> str:
        try:
            found = await services.run_job(
                "artifact",
                run_id,
                seconds=services.limits.check_seconds,
                name=artifact,
                from_step=_number("from_step", from_step),
                to_step=None if to_step is None else _number("to_step", to_step),
                every=_number("every", every, least=1),
                robot=robot,
                offset=_number("offset", offset),
                most=_MAX_BYTES,
            )
        except ToolError as error:
            raise ResourceNotFoundError(str(error)) from None
        return str(found["text"])

    description = (
        f"Part of a recorded run: {', '.join(ARTIFACTS)}. At most 1 MB per read: files and the data of replay.json "
        "continue with offset (characters), events and traces with from_step (their next_step); every=N takes every "
        "Nth step of a trace; robot selects one object and, in trace.json, adds its ranges."
    )
    server.resource(RUN, name="run", title="Recorded run", description=description, mime_type="text/plain")(
        run_artifact
    )


def _number(name: str, text: str, *, least: int = 0) -> int:
    """A whole number in a URI.

    Raises:
        ToolError: The text is not a whole number, or it is less than ``least``.
    """
    if not re.fullmatch("[0-9]{1,15}", text) or int(text) < least:
        what = f"{name} must be a whole number from {least} on, got {clean(text, 40)!r}"
        raise failure("bad-argument", what, where=name, fix=f"give a whole number from {least} on")
    return int(text)
