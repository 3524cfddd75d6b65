"""The replay of a run for hosts of MCP Apps: one static page that reads the run through its host.

The host passes the result of ``run_episode`` to the page, which reads ``irsim://runs/{run_id}/replay.json`` through the
host. It connects to nothing else, so it needs no permitted domains.
"""

from __future__ import annotations

from mcp.server.apps import APP_MIME_TYPE, Apps
from mcp.server.mcpserver.resources import FunctionResource

__all__ = ["PAGE", "replay_app"]

PAGE = "ui://irsim/replay"


def replay_app() -> Apps:
    """The extension with the page."""
    apps = Apps()
    apps.add_resource(
        FunctionResource(
            uri=PAGE,
            name="replay",
            title="Replay of a run",
            description="Shows what run_episode simulated; for hosts, not for models to read.",
            mime_type=APP_MIME_TYPE,
            meta={"ui": {"prefersBorder": True}},
            fn=_html,
        )
    )
    return apps


def _html() -> str:
    from irsim.runs.replay.page import page

    return page()
