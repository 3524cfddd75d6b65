"""A workspace that was deleted, renamed or replaced is said so by each tool, and is not made anew."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import anyio
import pytest

from irsim_mcp.server import build_server
from tests.mcp.conftest import LONG, ROOM, Caller, connected, error_of

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.anyio,
    pytest.mark.skipif(sys.platform == "win32", reason="a folder that is open cannot be deleted there"),
]

CALLS: dict[str, dict[str, Any]] = {
    "lookup": {"topic": "dash"},
    "validate_scenario": {"scenario_yaml": ROOM},
    "render_snapshot": {"scenario_path": "room.yaml"},
    "run_episode": {"scenario_yaml": ROOM},
    "inspect_run": {"run_id": "room-123456"},
    "benchmark": {"scenarios": ["room.yaml"], "seeds": 1},
    "get_job": {"job_id": "benchmark-123456"},
    "write_scenario": {"path": "new.yaml", "scenario_yaml": ROOM},
    "export_run": {"run_id": "room-123456", "to": "csv"},
}


def moved(folder: Path) -> Path:
    return folder.rename(folder.with_name("elsewhere"))


def replaced(folder: Path) -> None:
    moved(folder)
    folder.write_text("a file", encoding="utf-8")


def linked(folder: Path) -> None:
    folder.symlink_to(moved(folder))


def made_anew(folder: Path) -> None:
    shutil.rmtree(folder)
    folder.mkdir()


WAYS: dict[str, Callable[[Path], object]] = {
    "deleted": shutil.rmtree,
    "renamed": moved,
    "replaced by a file": replaced,
    "replaced by a link": linked,
    "deleted and made anew": made_anew,
}


@pytest.mark.parametrize("way", WAYS)
async def test_every_tool_says_it(workspace: Path, way: str) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    async with Caller(build_server(workspace, writing=True)) as client:
        assert {tool.name for tool in (await client.list_tools()).tools} == set(CALLS)
        WAYS[way](workspace)
        before = sorted(workspace.parent.rglob("*"))
        for tool, arguments in CALLS.items():
            told = await client.error(tool, **arguments)
            assert told.startswith(f"workspace-gone: the workspace {workspace} "), told
            assert told.endswith("Fix: put the folder back where it was, or start the server again.")
        with pytest.raises(Exception, match="workspace-gone"):
            await client.read_resource("irsim://runs/room-123456/trace.csv")
        assert sorted(workspace.parent.rglob("*")) == before


async def test_a_folder_that_comes_back_is_used_again(workspace: Path) -> None:
    async with connected(workspace) as client:
        away = moved(workspace)
        assert (await client.error("lookup", topic="dash")).startswith("workspace-gone: ")
        away.rename(workspace)
        assert not (await client.call("lookup", topic="dash")).is_error


async def test_it_goes_during_a_call(workspace: Path) -> None:
    told: list[str] = []

    async def on_progress(done: float, total: float | None, message: str | None) -> None:
        if workspace.exists():
            moved(workspace)
            tasks.cancel_scope.deadline = anyio.current_time() + 20

    async with connected(workspace, check_seconds=5) as client, anyio.create_task_group() as tasks:
        arguments = {"scenario_yaml": LONG, "max_steps": 30}
        told.append(error_of(await client.call_tool("run_episode", arguments, progress_callback=on_progress)))
    assert told[0].startswith("workspace-gone: ")
    assert not workspace.exists()
