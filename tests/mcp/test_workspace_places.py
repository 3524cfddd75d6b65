"""Workspaces in unusual places: behind links, on other mounts, renamed in a call, or with a pipe instead of records."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp

import pytest

from irsim_mcp.server import build_server
from tests.mcp.conftest import ROOM, Caller, Wire, linux, text_of

pytestmark = [
    pytest.mark.one_python,
    pytest.mark.skipif(sys.platform == "win32", reason="links of POSIX"),
]
QUIET = pytest.mark.anyio


@QUIET
@pytest.mark.parametrize("above", [False, True], ids=["itself", "its folder"])
async def test_a_link_that_is_given_is_followed_once(tmp_path: Path, above: bool) -> None:
    real, other = tmp_path / "real" / "w", tmp_path / "other" / "w"
    for folder in (real, other):
        folder.mkdir(parents=True)
        (folder / "room.yaml").write_text(ROOM.replace("rover", folder.parent.name), encoding="utf-8")
    link = tmp_path / "link"
    link.symlink_to(real.parent if above else real)
    client = Caller(build_server(link / "w" if above else link, writing=True), raise_exceptions=True)
    async with client:
        for _ in range(2):
            run = await client.data("run_episode", scenario_path="room.yaml", max_steps=2)
            assert [robot["name"] for robot in run["robots"]] == ["real"]
            link.unlink()
            link.symlink_to(other.parent if above else other)
        assert await client.data("export_run", run_id=run["run_id"], to="csv")
    assert {path.name for path in real.iterdir()} == {"room.yaml", ".irsim", "exports"}
    assert [path.name for path in other.iterdir()] == ["room.yaml"]


@linux
@QUIET
async def test_a_workspace_on_another_mount() -> None:
    if not os.access("/dev/shm", os.W_OK):
        pytest.skip("this machine has no second file system to write to")
    folder = Path(mkdtemp(dir="/dev/shm"))
    try:
        client = Caller(build_server(folder, writing=True), raise_exceptions=True)
        async with client:
            assert await client.data("write_scenario", path="rooms/a.yaml", yaml=ROOM)
            run = await client.data("run_episode", scenario_path="rooms/a.yaml", max_steps=2)
            for to in ("csv", "colmap", "colmap"):
                assert await client.data("export_run", run_id=run["run_id"], to=to)
            assert await client.data("benchmark", scenarios=["rooms/a.yaml"], seeds=1, max_steps=2)
    finally:
        rmtree(folder)


def _link(place: Path) -> None:
    (place.parent.parent / "outside").mkdir(exist_ok=True)
    place.symlink_to(place.parent.parent / "outside")


def _dangling(place: Path) -> None:
    place.symlink_to(place.parent.parent / "outside" / "nothing")


def _loop(place: Path) -> None:
    place.symlink_to(place.name)


def _folder_of_runs(place: Path) -> None:
    place.mkdir()
    os.mkfifo(place / "runs")
    os.mkfifo(place / "jobs")


PLACES: dict[str, Callable[[Path], object]] = {
    "a link": _link,
    "a link to nothing": _dangling,
    "a link to itself": _loop,
    "a pipe": os.mkfifo,
    "a file": lambda place: place.write_text("kept"),
    "a folder of pipes": _folder_of_runs,
}


@QUIET
@pytest.mark.rotates(4)
@pytest.mark.parametrize("what", PLACES)
@pytest.mark.parametrize("name", [".irsim", "exports"])
async def test_something_else_is_in_the_place_of_a_folder(
    writer: Caller, workspace: Path, name: str, what: str
) -> None:
    run = {"run_id": "a-123456"}
    if name == "exports":
        run = await writer.data("run_episode", scenario_yaml=ROOM, max_steps=2)
    PLACES[what](workspace / name)
    calls = [
        await writer.call("run_episode", scenario_yaml=ROOM, max_steps=2),
        await writer.call("export_run", run_id=run["run_id"], to="csv"),
        await writer.call("export_run", run_id=run["run_id"], to="colmap"),
        await writer.call("inspect_run", run_id=run["run_id"]),
        await writer.call("benchmark", scenarios=[ROOM], seeds=1, max_steps=2),
        await writer.call("get_job", job_id="benchmark-123456"),
        await writer.call("render_snapshot", run_id=run["run_id"], size_px=200),
    ]
    told = [text_of(call).partition(":")[0] for call in calls]
    assert not {"internal-error", "worker-failed"} & set(told)
    outside = workspace.parent / "outside"
    assert not outside.exists() or not list(outside.iterdir())
    if what == "a file":
        assert (workspace / name).read_text() == "kept"


@linux
def test_a_workspace_that_is_renamed_in_a_call_gets_no_answer_from_elsewhere(workspace: Path, wire: Wire) -> None:
    wire.start_long_run()
    workspace.rename(workspace.with_name("renamed"))
    workspace.mkdir()
    wire.send(method="notifications/cancelled", params={"requestId": 2})
    wire.call("validate_scenario", 3, scenario_yaml=ROOM)
    while (message := wire.receive()).get("id") != 3:
        pass
    assert "workspace-gone" in str(message)
    assert list(workspace.iterdir()) == []
    workspace.rmdir()
    workspace.with_name("renamed").rename(workspace)
    wire.call("validate_scenario", 4, scenario_yaml=ROOM)
    while (message := wire.receive()).get("id") != 4:
        pass
    assert not message["result"]["isError"]
