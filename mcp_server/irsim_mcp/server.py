"""The MCP server: its tools, resources and prompts for one workspace."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from mcp import MCPError
from mcp.server import MCPServer
from mcp.server.caching import CacheHint
from mcp.server.lowlevel.helper_types import ReadResourceContents
from mcp.server.mcpserver import Context
from mcp.server.mcpserver.exceptions import ResourceNotFoundError, ToolError
from mcp.types import INVALID_PARAMS, CallToolResult, GetPromptResult, InputRequiredResult, ResourceTemplate
from pydantic import AnyUrl

from irsim import __version__
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim_mcp.answers import failure
from irsim_mcp.call_log import CallLog
from irsim_mcp.jobs import Jobs
from irsim_mcp.limits import ServerLimits
from irsim_mcp.log import without_rich
from irsim_mcp.presence import Presence
from irsim_mcp.prompts import add_prompts
from irsim_mcp.resources import RUN, add_completions, add_docs, add_resources, add_run_resources, media_type, replay_app
from irsim_mcp.sandbox import Workspace
from irsim_mcp.services import Services
from irsim_mcp.skills import Skills
from irsim_mcp.stdio import standard_streams
from irsim_mcp.tools import make_tools
from irsim_mcp.worker import Workers

__all__ = ["IrsimServer", "build_server"]

_INSTRUCTIONS = """\
irsim simulates robots that drive in a flat world: walls and obstacles, several robots, lidars, collisions. A scenario \
is one YAML document with the keys world, robot and obstacle; lengths are m, times s, angles rad, x points right, y up.
Work in this order: lookup (all topics in one call, then the nearest template; for a file of the user only what you \
change) -> edit the YAML -> validate_scenario checks it, render_snapshot draws it, run_episode with seeds=3 does both \
and runs it, in one call (with base: what an edit changed) -> if it failed, inspect_run, edit and repeat. To compare \
behaviors: benchmark, then get_job while it runs. Do not guess keys: lookup explains them, misspelt ones are errors. \
Say what cannot be done instead of leaving it out.
Scenarios are given as text (scenario_yaml) or as a file (scenario_path) inside the workspace {workspace}. The server \
writes no files except recorded runs and jobs below .irsim; {saving}. The same scenario and seed \
give the same result."""
_SAVING = {
    False: "save YAML that must be kept yourself",
    True: "write_scenario saves a scenario that must be kept, export_run writes a run for another program",
}
_HOUR_MS = 3_600_000
_MINUTE_MS = 60_000


class IrsimServer(MCPServer[Any]):
    """A server that suggests similar names for unknown tools and checks the arguments of prompts.

    Attributes:
        calls: Where calls of tools are recorded; None if nowhere.
        presence: Whether the workspace is there.
    """

    calls: CallLog | None = None
    presence: Presence

    async def run_stdio_async(self) -> None:
        """Serve over standard input and output."""
        async with standard_streams() as (messages, answers):
            options = self._lowlevel_server.create_initialization_options()
            await self._lowlevel_server.run(messages, answers, options)

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        """Call a tool, or suggest a similar name if there is no such tool; record the call if that is wanted."""
        if self.calls is None:
            return await self._call(name, arguments, context)
        begin = self.calls.now()
        answer: object = None
        try:
            answer = result = await self._call(name, arguments, context)
        except BaseException as error:  # a call that was cancelled is recorded, too
            answer = error
            raise
        finally:
            self.calls.record(name, arguments, answer, begin)
        return result

    async def _call(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None
    ) -> CallToolResult | InputRequiredResult:
        names = [tool.name for tool in await self.list_tools()]
        if name not in names:
            fix = suggestion(name, names, f"the tools are {', '.join(names)}")
            raise failure("unknown-tool", f"there is no tool {clean(name)!r}", fix=fix)
        self.presence.check()
        try:
            result = await super().call_tool(name, arguments, context)
        except ToolError:
            self.presence.check()  # which is why it failed
            raise
        self.presence.check()
        return result

    async def list_resource_templates(self) -> list[ResourceTemplate]:
        """The resource templates; the template of runs has no media type, as each artifact has its own."""
        listed = await super().list_resource_templates()
        return [one.model_copy(update={"mime_type": None}) if one.uri_template == RUN else one for one in listed]

    async def read_resource(
        self, uri: AnyUrl | str, context: Context[Any, Any] | None = None
    ) -> Iterable[ReadResourceContents] | InputRequiredResult:
        """Read a resource; artifacts of runs have the media type of their name."""
        kind = media_type(str(uri))
        if kind is not None:
            try:
                self.presence.check()
            except ToolError as gone:
                raise ResourceNotFoundError(str(gone)) from None
        contents = await super().read_resource(uri, context)
        if kind is None or isinstance(contents, InputRequiredResult):
            return contents
        return [replace(content, mime_type=kind) for content in contents]

    async def get_prompt(
        self, name: str, arguments: dict[str, Any] | None = None, context: Context[Any, Any] | None = None
    ) -> GetPromptResult | InputRequiredResult:
        """Fill in a prompt after checking its arguments."""
        prompts = {prompt.name: prompt for prompt in await self.list_prompts()}
        if name not in prompts:
            fix = f"the prompts are {', '.join(prompts)}"
            raise MCPError(
                INVALID_PARAMS, str(failure("unknown-prompt", f"there is no prompt {clean(name)!r}", fix=fix))
            )
        known = {argument.name: argument.required for argument in prompts[name].arguments or ()}
        missing = [argument for argument, needed in known.items() if needed and argument not in (arguments or {})]
        unknown = [clean(argument) for argument in arguments or {} if argument not in known]
        if missing or unknown:
            wrong = f"needs {', '.join(missing)}" if missing else f"has no argument {', '.join(unknown[:3])}"
            refused = failure("bad-argument", f"{name} {wrong}", fix=f"its arguments are {', '.join(known)}")
            raise MCPError(INVALID_PARAMS, str(refused))
        return await super().get_prompt(name, arguments, context)


def build_server(
    workspace: Path, limits: ServerLimits | None = None, *, writing: bool = False, calls: CallLog | None = None
) -> IrsimServer:
    """Build the server of a workspace.

    Args:
        workspace: The folder from which scenarios are read.
        limits: Limits of a call.
        writing: Whether scenarios may also be written to the workspace.
        calls: Where calls of tools are recorded.
    """
    limits = limits or ServerLimits()
    folder = Workspace(workspace)
    services = Services(folder, limits, Workers(folder, limits), Jobs(folder, limits))
    lists = ("tools/list", "prompts/list", "resources/list", "resources/templates/list")
    caching: dict[Any, CacheHint] = {method: CacheHint(ttl_ms=_HOUR_MS, scope="public") for method in lists}
    caching["resources/read"] = CacheHint(
        ttl_ms=_MINUTE_MS, scope="private"
    )  # recorded runs change while they are simulated
    with without_rich():
        server = IrsimServer(
            "irsim",
            title="irsim: 2D robot navigation",
            version=__version__,
            instructions=_INSTRUCTIONS.format(workspace=clean(folder.root, 300), saving=_SAVING[writing]),
            tools=make_tools(services, writing=writing),
            cache_hints=caching,
            extensions=[Skills(), replay_app()],
            log_level="WARNING",
        )
    server.calls = calls
    server.presence = Presence(folder)
    add_resources(server, services)
    add_docs(server)
    add_run_resources(server, services)
    add_prompts(server, services)
    add_completions(server, services)
    return server
