"""``export_run``: only on demand, only into one folder of the workspace; and bridges, which are closed by default."""

from __future__ import annotations

import json
import socket
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcp import Client

from irsim_mcp.limits import ServerLimits
from irsim_mcp.server import build_server
from tests.bridges.peer import Peer
from tests.mcp.conftest import ROOM, connected, data_of, error_of, text_of

pytestmark = pytest.mark.anyio
MOST_BYTES = 1_700


async def recorded(client: Client) -> str:
    run_id: str = data_of(await client.call_tool("run_episode", {"scenario_yaml": ROOM}))["run_id"]
    return run_id


async def test_it_is_there_only_on_demand(empty: Path) -> None:
    async with connected(empty) as client:
        assert "export_run" not in [tool.name for tool in (await client.list_tools()).tools]
    async with Client(build_server(empty, writing=True), raise_exceptions=True) as client:
        tools = {tool.name: tool for tool in (await client.list_tools()).tools}
    tool = tools["export_run"].model_dump(mode="json", by_alias=True, exclude_none=True)
    assert len(json.dumps(tool, separators=(",", ":"))) <= MOST_BYTES
    assert "Next: " in tool["description"]


async def test_a_run_becomes_a_file_of_the_workspace(workspace: Path) -> None:
    async with Client(build_server(workspace, writing=True), raise_exceptions=True) as client:
        run_id = await recorded(client)
        for _ in range(2):
            result = await client.call_tool("export_run", {"run_id": run_id, "to": "npz"})
            data = data_of(result)
            assert data["path"] == f"exports/{run_id}.npz"
            assert data["summary"] in text_of(result)
        with np.load(workspace / data["path"]) as arrays:
            assert len(arrays["step"]) == data["steps"] + 1
        told = error_of(await client.call_tool("export_run", {"run_id": run_id, "to": "xyzzy"}))
        assert "unknown-format" in told
        assert "npz" in told
        told = error_of(await client.call_tool("export_run", {"run_id": run_id, "to": "csv", "objects": "rob"}))
        assert "rob" in told
    assert [path.name for path in (workspace / "exports").iterdir()] == [f"{run_id}.npz"]


@pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX")
async def test_it_follows_no_link(workspace: Path) -> None:
    outside = workspace.parent / "outside"
    outside.mkdir()
    (workspace / "exports").symlink_to(outside)
    async with Client(build_server(workspace, writing=True), raise_exceptions=True) as client:
        run_id = await recorded(client)
        assert "not-a-file" in error_of(await client.call_tool("export_run", {"run_id": run_id, "to": "npz"}))
    assert list(outside.iterdir()) == []


def connecting(address: str) -> dict[str, Any]:
    return {"scenario_yaml": ROOM + f"bridges: [{{name: json_lines, address: '{address}'}}]\n"}


async def test_no_connection_is_opened_unless_the_server_may(workspace: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        address = f"127.0.0.1:{server.getsockname()[1]}"
        async with connected(workspace) as client:
            assert data_of(await client.call_tool("validate_scenario", connecting(address)))["valid"]
            told = error_of(await client.call_tool("run_episode", connecting(address)))
            assert "bridges-disabled" in told
            assert "--enable-bridges" in told
            benchmark = {"scenarios": [connecting(address)["scenario_yaml"]], "behaviors": ["dash"], "seeds": 1}
            await client.call_tool("benchmark", benchmark)
        with pytest.raises(TimeoutError):
            server.accept()


async def test_a_server_that_may_opens_them(workspace: Path) -> None:
    limits = ServerLimits(bridges=True)
    with Peer(lambda message: None) as peer:
        async with Client(build_server(workspace, limits), raise_exceptions=True) as client:
            run = data_of(await client.call_tool("run_episode", connecting(peer.address)))
    assert peer.kinds()[0] == "scene"
    assert peer.kinds().count("state") == run["steps"]


async def test_a_program_that_leaves_is_what_the_run_says(workspace: Path) -> None:
    def leaving(message: dict[str, Any]) -> Any:
        return b"" if message["kind"] == "state" and message["step"] == 3 else {}

    with Peer(leaving) as peer:
        text = connecting(peer.address)["scenario_yaml"].replace("'}]", "', answers: true, timeout: 0.5}]")
        async with Client(build_server(workspace, ServerLimits(bridges=True)), raise_exceptions=True) as client:
            run = data_of(await client.call_tool("run_episode", {"scenario_yaml": text}))
    assert (run["outcome"], run["steps"]) == ("timeout", 3)
    assert "did not answer within 0.5 s; the run ended" in run["reason"]
    assert run["summary"].endswith("the program of a bridge was lost, which ended the run")
    assert run["next"].startswith("The program of a bridge was lost: start it again, then run_episode ")
