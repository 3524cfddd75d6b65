"""``export_run``: only on demand, only into one folder of the workspace; and bridges, which are closed by default."""

from __future__ import annotations

import socket
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from irsim_mcp.limits import ServerLimits
from irsim_mcp.server import build_server
from tests.bridges.peer import Peer
from tests.mcp.conftest import ROOM, Caller, connected, data_of, text_of

pytestmark = pytest.mark.anyio


async def recorded(client: Caller) -> str:
    run_id: str = (await client.data("run_episode", scenario_yaml=ROOM))["run_id"]
    return run_id


def beside(workspace: Path) -> Path:
    """A new folder outside the workspace."""
    outside = workspace.parent / "outside"
    outside.mkdir()
    return outside


async def test_a_run_becomes_a_file_of_the_workspace(writer: Caller, workspace: Path) -> None:
    run_id = await recorded(writer)
    for _ in range(2):
        result = await writer.call("export_run", run_id=run_id, to="npz")
        data = data_of(result)
        assert data["path"] == f"exports/{run_id}.npz"
        assert data["summary"] in text_of(result)
    with np.load(workspace / data["path"]) as arrays:
        assert len(arrays["step"]) == data["steps"] + 1
    told = await writer.error("export_run", run_id=run_id, to="xyzzy")
    assert "unknown-format" in told
    assert "npz" in told
    told = await writer.error("export_run", run_id=run_id, to="csv", objects="rob")
    assert "rob" in told
    assert [path.name for path in (workspace / "exports").iterdir()] == [f"{run_id}.npz"]


@pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX")
async def test_it_follows_no_link(writer: Caller, workspace: Path) -> None:
    outside = beside(workspace)
    (workspace / "exports").symlink_to(outside)
    run_id = await recorded(writer)
    assert "not-a-file" in await writer.error("export_run", run_id=run_id, to="npz")
    assert list(outside.iterdir()) == []


@pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX")
async def test_an_earlier_folder_stays_until_there_is_another_one(writer: Caller, workspace: Path) -> None:
    outside = beside(workspace)
    (outside / "keep").touch()
    run_id = await recorded(writer)
    wanted = {"run_id": run_id, "to": "colmap"}
    folder = workspace / (await writer.data("export_run", **wanted))["path"]
    before = sorted(folder.iterdir())
    assert "rob" in await writer.error("export_run", **wanted, objects="rob")
    assert sorted(folder.iterdir()) == before
    (folder / "note").touch()
    await writer.call_tool("export_run", wanted)
    assert sorted(folder.iterdir()) == before
    assert [path.name for path in folder.parent.iterdir()] == [folder.name]
    folder.rename(outside / "moved")
    for blocking in (lambda: folder.symlink_to(outside), folder.touch):
        blocking()
        told = await writer.error("export_run", **wanted)
        assert "file-exists" in told
        assert "is in the way" in told
        folder.unlink()
    assert sorted(path.name for path in outside.iterdir()) == ["keep", "moved"]


def connecting(address: str) -> dict[str, Any]:
    return {"scenario_yaml": ROOM + f"bridges: [{{name: json_lines, address: '{address}'}}]\n"}


async def test_no_connection_is_opened_unless_the_server_may(workspace: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(0.2)
        address = f"127.0.0.1:{server.getsockname()[1]}"
        async with connected(workspace) as client:
            assert (await client.data("validate_scenario", **connecting(address)))["valid"]
            told = await client.error("run_episode", **connecting(address))
            assert "bridges-disabled" in told
            assert "--enable-bridges" in told
            benchmark = {"scenarios": [connecting(address)["scenario_yaml"]], "behaviors": ["dash"], "seeds": 1}
            await client.call_tool("benchmark", benchmark)
        with pytest.raises(TimeoutError):
            server.accept()


async def test_a_server_that_may_opens_them(workspace: Path) -> None:
    limits = ServerLimits(bridges=True)
    with Peer(lambda message: None) as peer:
        async with Caller(build_server(workspace, limits), raise_exceptions=True) as client:
            run = await client.data("run_episode", **connecting(peer.address))
    assert peer.kinds()[0] == "scene"
    assert peer.kinds().count("state") == run["steps"]


async def test_a_program_that_leaves_is_what_the_run_says(workspace: Path) -> None:
    def leaving(message: dict[str, Any]) -> Any:
        return b"" if message["kind"] == "state" and message["step"] == 3 else {}

    with Peer(leaving) as peer:
        text = connecting(peer.address)["scenario_yaml"].replace("'}]", "', answers: true, timeout: 0.5}]")
        async with Caller(build_server(workspace, ServerLimits(bridges=True)), raise_exceptions=True) as client:
            run = await client.data("run_episode", scenario_yaml=text)
    assert (run["outcome"], run["steps"]) == ("timeout", 3)
    assert "did not answer within 0.5 s; the run ended" in run["reason"]
    assert run["summary"].endswith("the program of a bridge was lost, which ended the run")
    assert run["next"].startswith("The program of a bridge was lost: start it again, then run_episode ")
