"""A disk without space, and a folder with a scenario and a recorded run, for tests of what is written to it."""

from __future__ import annotations

import errno
import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from irsim.cli.app import app

__all__ = ["assert_said_and_nothing_left", "disk", "here"]

HALL = "image: hall.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
ROOM = """\
world: {width: 6, height: 6}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [5, 5],
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 200}]}
obstacle:
  - {name: walker, kinematics: {name: omni}, tags: [pedestrian], shape: {name: circle, radius: 0.2}, state: [1, 5, 0],
     goal: [5, 5.5], behavior: {name: dash}}
"""
MAPPED = "world: {width: 10, height: 10, obstacle_map: {name: image, path: hall.png}}\n"
WALK = "".join(f"{10 * row} {who} {1 + 0.3 * row} {1 + who}\n" for who in (1, 2) for row in range(10))


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder on a full disk; where no disk can be mounted, the last step of each writing fails as on one."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4k", "irsim-test", str(place)]
    if os.name == "posix" and subprocess.run(mount, capture_output=True, check=False).returncode == 0:
        try:
            (place / "filler").write_bytes(b"x" * 4096)
            yield place
        finally:
            subprocess.run(["umount", "-l", str(place)], check=True)
        return

    def full(*names: object, **options: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(names[1]))

    for call in ("replace", "rename", "link"):
        monkeypatch.setattr(os, call, full)
    yield place


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with scenarios, maps, recorded people and a recorded run."""
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    for name in ("hall.pgm", "hall.png"):
        Image.new("L", (20, 20), 255).save(name)
    Path("hall.yaml").write_text(HALL, encoding="utf-8")
    Path("mapped.yaml").write_text(MAPPED, encoding="utf-8")
    Path("walk.txt").write_text(WALK, encoding="utf-8")
    assert CliRunner().invoke(app, ["run", "room.yaml", "--record"]).exit_code == 0


def assert_said_and_nothing_left(command: str, disk: Path, *, hidden_only: bool = False) -> None:
    """Run a command that writes to the disk: it says that the disk is full, and leaves no file on it.

    Args:
        command: The command, in which ``{disk}`` stands for the folder.
        disk: The folder.
        hidden_only: Other files than hidden ones may stay.
    """
    before = sorted(path.name for path in disk.rglob("*"))
    done = CliRunner().invoke(app, command.format(disk=disk).split())
    assert "disk-full" in done.stderr, done.output
    assert done.exit_code == 1
    left = sorted(path.name for path in disk.rglob("*") if path.is_file())
    assert [file for file in left if file not in before and (file.startswith(".") or not hidden_only)] == []
