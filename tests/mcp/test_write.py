"""``write_scenario``: only on demand, only valid scenarios, only YAML files of the workspace, all or nothing."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import anyio
import pytest

from irsim_mcp import sandbox
from irsim_mcp.sandbox import Workspace
from tests.mcp.conftest import ERAS, ROOM, Caller, data_of, text_of
from tests.mcp.golden.write import listed

pytestmark = [pytest.mark.one_python, pytest.mark.anyio]

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and permissions of POSIX")
MOST_BYTES = 1_700
PATHS = {
    "above": ("../room.yaml", "path-outside-workspace"),
    "above, hidden": ("a/../../room.yaml", "path-outside-workspace"),
    "absolute": ("/tmp/room.yaml", "path-outside-workspace"),
    "drive": ("C:\\room.yaml", "path-outside-workspace"),
    "share": ("\\\\host\\share\\room.yaml", "path-outside-workspace"),
    "backslashes": ("..\\room.yaml", "path-outside-workspace"),
    "backslashes downwards": ("a\\room.yaml", "bad-argument"),
    "home": ("~/room.yaml", "path-outside-workspace"),
    "NUL": ("room.yaml\0.png", "path-outside-workspace"),
    "line break": ("room\n.yaml", "path-outside-workspace"),
    "turned around": ("room\u202elmay.exe.yaml", "path-outside-workspace"),
    "stream": ("room.yaml:hidden.yaml", "bad-argument"),
    "device": ("con.yaml", "path-outside-workspace"),
    "suffix": ("room.py", "bad-argument"),
    "capitals": ("room.YAML", "bad-argument"),
    "no suffix": ("room", "bad-argument"),
    "suffix only": (".yaml", "bad-argument"),
    "empty": ("", "bad-argument"),
    "dot": (".", "bad-argument"),
    "long": ("x" * 210 + ".yaml", "bad-argument"),
    "records": (".irsim/runs/room.yaml", "bad-argument"),
    "workflow": (".github/workflows/room.yaml", "bad-argument"),
    "link out": ("link.yaml", "path-outside-workspace"),
    "link inside": ("alias.yaml", "path-outside-workspace"),
    "dangling link": ("dangling.yaml", "path-outside-workspace"),
    "folder link out": ("out/room.yaml", "path-outside-workspace"),
    "folder link inside": ("in/room.yaml", "path-outside-workspace"),
    "folder": ("folder.yaml", "not-a-file"),
    "pipe": ("pipe.yaml", "path-outside-workspace"),
    "below a file": ("there.yaml/room.yaml", "file-access"),
}


def tree(folder: Path) -> dict[str, str]:
    """Everything below a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8") if path.is_file() else "-"
        for path in sorted(folder.rglob("*"))
        if ".irsim" not in path.parts
    }


@pytest.mark.parametrize("era", ERAS)
async def test_tools_that_write_are_there_only_on_demand(client: Caller, writer: Caller) -> None:
    without, tools = [
        {tool["name"]: tool for tool in listed((await one.list_tools()).tools)} for one in (client, writer)
    ]
    assert tools.keys() - without == {"write_scenario", "export_run"}
    assert "save YAML that must be kept yourself" in (client.instructions or "")
    assert "write_scenario saves" in (writer.instructions or "")
    for name in ("write_scenario", "export_run"):
        assert len(json.dumps(tools[name], separators=(",", ":"))) <= MOST_BYTES
        assert "Next: " in tools[name]["description"]
    hints = {"readOnlyHint": False, "destructiveHint": True, "idempotentHint": True, "openWorldHint": False}
    assert tools["write_scenario"]["annotations"] == hints
    taken = tools["write_scenario"]["inputSchema"]
    assert (taken["required"], taken["additionalProperties"]) == (["path", "yaml"], False)


@pytest.mark.parametrize("era", ERAS)
async def test_writing(writer: Caller, workspace: Path) -> None:
    result = await writer.call("write_scenario", path="rooms/new/a.yaml", yaml=ROOM)
    data = data_of(result)
    assert (data["path"], data["bytes"], data["replaced"]) == ("rooms/new/a.yaml", len(ROOM), False)
    assert data["summary"] in text_of(result)
    assert data["next"] in text_of(result)
    assert "1 robot, no obstacles" in data["summary"]
    assert (await writer.data("validate_scenario", scenario_path="rooms/new/a.yaml"))["valid"]
    other = ROOM.replace("rover", "größer")
    told = await writer.error("write_scenario", path="rooms/new/a.yaml", yaml=other)
    assert told.startswith("file-exists: 'rooms/new/a.yaml' exists already (path). Fix: overwrite=true")
    assert tree(workspace) == {"rooms": "-", "rooms/new": "-", "rooms/new/a.yaml": ROOM}
    assert (await writer.data("write_scenario", path="rooms/new/a.yaml", yaml=other, overwrite=True))["replaced"]
    assert tree(workspace)["rooms/new/a.yaml"] == other


@pytest.mark.parametrize(
    ("yaml", "said"),
    [
        (ROOM.replace("radius", "radios"), "unknown-key"),
        ("world: {width: !!python/name:os.system }\n", "unsupported-tag"),
        ("", "empty-document"),
        ("on: push\njobs: {}\n", "unknown-key"),
        (ROOM + "    description: ../secret.png\n", "path-outside-workspace"),
        ("robot: {name: '\ud800'}\n", "not-text"),
        ("#" * 300_000, "file-too-large"),
    ],
)
async def test_what_is_not_valid_is_not_written(writer: Caller, workspace: Path, yaml: str, said: str) -> None:
    (workspace / "room.yaml").write_text(ROOM, encoding="utf-8")
    told = await writer.error("write_scenario", path="room.yaml", yaml=yaml, overwrite=True)
    assert said in told
    assert tree(workspace) == {"room.yaml": ROOM}


async def test_files_it_names_are_looked_for_beside_it(writer: Caller, workspace: Path) -> None:
    (workspace / "rooms").mkdir()
    (workspace / "rooms" / "map.png").write_bytes(
        Path(__file__).parents[2].joinpath("skills/irsim-scenario/examples/cafe/snapshot.png").read_bytes()
    )
    yaml = ROOM.replace("world: {", "world: {obstacle_map: map.png, ")
    told = await writer.error("write_scenario", path="other/a.yaml", yaml=yaml)
    assert "map" in told
    assert not (workspace / "other").exists()
    assert (await writer.data("write_scenario", path="rooms/a.yaml", yaml=yaml))["path"] == "rooms/a.yaml"


@POSIX
@pytest.mark.parametrize("name", PATHS)
async def test_paths(writer: Caller, workspace: Path, name: str) -> None:
    outside = workspace.parent / "outside"
    outside.mkdir()
    (outside / "secret.yaml").write_text("secret", encoding="utf-8")
    (workspace / "link.yaml").symlink_to(outside / "secret.yaml")
    (workspace / "dangling.yaml").symlink_to(outside / "new.yaml")
    (workspace / "out").symlink_to(outside)
    (workspace / "there.yaml").write_text(ROOM, encoding="utf-8")
    (workspace / "alias.yaml").symlink_to("there.yaml")
    (workspace / "folder.yaml").mkdir()
    (workspace / "in").symlink_to("folder.yaml")
    os.mkfifo(workspace / "pipe.yaml")
    before = tree(workspace), tree(outside)
    path, code = PATHS[name]
    told = await writer.error("write_scenario", path=path, yaml=ROOM, overwrite=True)
    assert told.startswith(f"{code}: ")
    assert (tree(workspace), tree(outside)) == before


@POSIX
@pytest.mark.parametrize("overwrite", [False, True])
async def test_links_that_appear_after_the_check_are_not_followed(workspace: Path, overwrite: bool) -> None:
    """Another process that may write in the workspace cannot redirect a file elsewhere by being quick."""
    from mcp.server.mcpserver.exceptions import ToolError

    outside = workspace.parent / "outside"
    outside.mkdir()
    (outside / "secret.yaml").write_text("secret", encoding="utf-8")
    (workspace / "rooms").symlink_to(outside)
    with pytest.raises(ToolError, match="file-access"):
        Workspace(workspace).write("rooms/secret.yaml", b"x", overwrite)
    (workspace / "a.yaml").symlink_to(outside / "secret.yaml")
    if overwrite:
        assert Workspace(workspace).write("a.yaml", b"x", True)
        assert not (workspace / "a.yaml").is_symlink()
    else:
        with pytest.raises(ToolError, match="file-exists"):
            Workspace(workspace).write("a.yaml", b"x", False)
    assert tree(outside) == {"secret.yaml": "secret"}


async def test_of_many_at_once_one_wins_and_the_file_is_whole(workspace: Path) -> None:
    told: list[bool] = []

    async def one(number: int) -> None:
        text = ROOM + "#" * 50_000 + str(number)
        try:
            await anyio.to_thread.run_sync(Workspace(workspace).write, "a.yaml", text.encode(), False)
        except Exception:
            told.append(False)
        else:
            told.append(True)

    async with anyio.create_task_group() as group:
        for number in range(8):
            group.start_soon(one, number)
    assert sorted(told) == [False] * 7 + [True]
    assert list(tree(workspace)) == ["a.yaml"]
    assert (workspace / "a.yaml").stat().st_size == len(ROOM) + 50_001


@POSIX
@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may write everywhere")
async def test_folders_that_may_not_be_written(writer: Caller, workspace: Path) -> None:
    workspace.chmod(0o500)
    told = await writer.error("write_scenario", path="a.yaml", yaml=ROOM)
    workspace.chmod(0o700)
    assert told.startswith("file-access: ")


def test_without_descriptors_it_works_too(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sandbox, "AVAILABLE", False)
    assert not Workspace(workspace).write("a/b.yaml", b"x", False)
    assert Workspace(workspace).write("a/b.yaml", b"y", True)
    assert tree(workspace) == {"a": "-", "a/b.yaml": "y"}
