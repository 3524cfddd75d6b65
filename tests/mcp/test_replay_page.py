"""The page for hosts of MCP Apps, as the server offers it."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import pytest
from mcp.server.apps import APP_MIME_TYPE, EXTENSION_ID

from irsim.runs import open_run
from irsim.runs.replay.page import page
from irsim_mcp.resources import PAGE
from tests.mcp.conftest import CRASH, ERAS, Caller
from tests.runs.replay.reading import unpacked

pytestmark = pytest.mark.anyio


@pytest.mark.parametrize("era", ERAS)
async def test_run_episode_points_at_the_page(client: Caller, era: str) -> None:
    tools = (await client.list_tools()).tools
    listed = (await client.list_resources()).resources
    (content,) = (await client.read_resource(PAGE)).contents
    extensions = client.server_capabilities.extensions if client.server_capabilities else None
    pages = {tool.name: tool.meta for tool in tools if tool.meta}
    assert pages == {"run_episode": {"ui": {"resourceUri": PAGE}}}
    assert [str(item.uri) for item in listed if item.mime_type == APP_MIME_TYPE] == [PAGE]
    assert content.mime_type == APP_MIME_TYPE
    assert content.text == page()
    assert len(content.text.encode()) <= 3_000_000
    assert content.meta == {"ui": {"prefersBorder": True}}
    if era != "legacy":
        assert EXTENSION_ID in (extensions or {})


async def test_the_page_can_read_a_run(client: Caller, workspace: Path) -> None:
    (workspace / "matplotlibrc").write_text("lines.linewidth: nonsense\n")
    run_id = (await client.data("run_episode", scenario_yaml=CRASH, seed=3))["run_id"]
    (content,) = (await client.read_resource(f"irsim://runs/{run_id}/replay.json?offset=0")).contents
    part = json.loads(content.text)
    assert len(part["data"]) == part["total"]
    head, columns = unpacked(base64.b64decode(part["data"]))
    assert columns["step"].tolist() == open_run(run_id, workspace).trace().step.tolist()
    assert head["outcome"] == "collision"
