"""The MCP server as a process of its own, called by the client of the MCP SDK over standard input and output."""

from __future__ import annotations

import contextlib
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from typing import Any, NamedTuple

from anyio.from_thread import BlockingPortal, start_blocking_portal
from mcp import Client, StdioServerParameters
from mcp.client.stdio import stdio_client
from mcp.types import TextContent

__all__ = ["Server", "started"]


class Server(NamedTuple):
    """Calls tools of a server that runs."""

    portal: BlockingPortal
    client: Client

    def validate(self, text: str) -> dict[str, Any] | None:
        """All findings of a scenario, as ``irsim validate --json`` has them; None if the tool could not say."""
        return self._call("validate_scenario", scenario_yaml=text, simulate=False, max_issues=100)

    def run(self, text: str) -> dict[str, Any] | None:
        """The result of one episode, as ``irsim run --json`` has it; None if the scenario does not run."""
        return self._call("run_episode", scenario_yaml=text)

    def _call(self, tool: str, **arguments: Any) -> dict[str, Any] | None:
        result = self.portal.call(self.client.call_tool, tool, {**arguments, "response_format": "json"})
        content = result.content[0] if result.content else None
        if result.is_error or not isinstance(content, TextContent):
            return None
        answer: dict[str, Any] = json.loads(content.text)
        return answer


@contextlib.contextmanager
def started() -> Iterator[Server]:
    """Start a server in an empty folder; it ends with the context."""
    with (
        tempfile.TemporaryDirectory(prefix="irsim-evals-") as folder,
        open(os.devnull, "w", encoding="utf-8") as unread,  # its workers complain when the folder goes away
        start_blocking_portal() as portal,
    ):
        arguments = ["-m", "irsim_mcp", "--workspace", folder]
        command = StdioServerParameters(command=sys.executable, args=arguments, env=dict(os.environ))
        with portal.wrap_async_context_manager(Client(stdio_client(command, errlog=unread))) as client:
            yield Server(portal, client)
