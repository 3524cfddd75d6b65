"""The server: its tools and some resources over one workspace."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mcp.server import MCPServer
from mcp.server.caching import CacheHint
from mcp.server.mcpserver import Context
from mcp.types import CallToolResult, InputRequiredResult

from irsim import __version__
from irsim.text import clean
from irsim_mcp.errors import failure
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.resources import add_resources
from irsim_mcp.run_resources import add_run_resources
from irsim_mcp.sandbox import Workspace
from irsim_mcp.services import Services
from irsim_mcp.tools import (
    benchmark,
    get_job,
    inspect_run,
    lookup,
    render_snapshot,
    run_episode,
    validate_scenario,
)
from irsim_mcp.worker import Workers

__all__ = ["IrsimServer", "build_server"]

_INSTRUCTIONS = """\
irsim simulates robots that drive in a flat world: walls and obstacles, several robots, lidars, collisions. A scenario \
is one YAML document with the keys world, robot and obstacle; lengths are m, times s, angles rad, x points right, y up.
Work in this order: lookup (index, then the nearest template; for a file of the user only what you change) -> edit \
the YAML -> validate_scenario until valid -> \
render_snapshot and look -> run_episode -> if it failed, inspect_run, look at that moment, edit, and again. To compare \
behaviors: benchmark, then get_job while it runs. Do not guess keys: lookup explains them, misspelt ones are errors. \
Say what cannot be done instead of leaving it out.
Scenarios are given as text (scenario_yaml) or as a file (scenario_path) inside the workspace {workspace}. The server \
writes no files but records below .irsim; save YAML yourself if it is to be kept. The same scenario and seed \
give the same result."""
_HOUR = 3_600_000


class IrsimServer(MCPServer[Any]):
    """A server that names the nearest tool when there is none of the name asked for."""

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """Call a tool."""
        names = [tool.name for tool in await self.list_tools()]
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            fix = f"did you mean {near[0]}?" if near else f"there are {', '.join(names)}"
            raise failure("unknown-tool", f"there is no tool {clean(name)!r}", fix=fix)
        return await super().call_tool(name, arguments, context)


def build_server(workspace: Path, limits: ServerLimits | None = None) -> IrsimServer:
    """Make a server.

    Args:
        workspace: The folder that scenarios are read from.
        limits: What a call may cost.
    """
    limits = limits or ServerLimits()
    folder = Workspace(workspace)
    services = Services(folder, limits, Workers(folder, limits), Jobs(folder, limits))
    modules = (lookup, validate_scenario, render_snapshot, run_episode, inspect_run, benchmark, get_job)
    caching: Mapping[Any, CacheHint] = {
        method: CacheHint(ttl_ms=_HOUR, scope="public")
        for method in ("tools/list", "resources/list", "resources/templates/list", "resources/read")
    }
    server = IrsimServer(
        "irsim",
        title="irsim: 2D robot navigation",
        version=__version__,
        instructions=_INSTRUCTIONS.format(workspace=clean(folder.root, 300)),
        tools=[module.tool(services) for module in modules],
        cache_hints=caching,
        log_level="WARNING",
    )
    add_resources(server)
    add_run_resources(server, services)
    return server
