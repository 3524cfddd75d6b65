"""A disk without space: every command that writes says so with one code, and leaves nothing incomplete behind."""

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
from irsim.common.files import is_disk_full

COMMANDS = {
    "new": "new maze -o {disk}/new.yaml",
    "picture": "render room.yaml -o {disk}/picture.png",
    "strip": "render room.yaml --strip 3 -o {disk}/strip.png",
    "gif": "render room.yaml --steps 60 -o {disk}/film.gif",
    "film": "render room.yaml --steps 60 -o {disk}/film.mp4",
    "record": "run room.yaml --record-to {disk}/run",
    "run --export": "run room.yaml --export {disk}/run.csv",
    "csv": "export last --to csv -o {disk}/run.csv",
    "npz": "export last --to npz -o {disk}/run.npz",
    "sdf": "export last --to sdf -o {disk}/run.sdf",
    "mjcf": "export last --to mjcf -o {disk}/run.xml",
    "openscenario": "export last --to openscenario -o {disk}/run.xosc",
    "map": "map import hall.yaml -o {disk}/hall.yaml",
    "replay": "replay last -o {disk}/replay.html",
    "benchmark": "benchmark room.yaml --seeds 2 --workers 1 -o {disk}/benchmark",
}
HALL = "image: hall.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
ROOM = """\
world: {width: 6, height: 6}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [5, 5],
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 200}]}
"""


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

    for call in ("replace", "rename"):
        monkeypatch.setattr(os, call, full)
    yield place


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder with a scenario and a recorded run."""
    monkeypatch.chdir(tmp_path)
    Path("room.yaml").write_text(ROOM, encoding="utf-8")
    Image.new("L", (20, 20), 255).save("hall.pgm")
    Path("hall.yaml").write_text(HALL, encoding="utf-8")
    assert CliRunner().invoke(app, ["run", "room.yaml", "--record"]).exit_code == 0


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.usefixtures("here")
def test_a_full_disk_is_said_and_nothing_is_left(name: str, disk: Path) -> None:
    before = sorted(path.name for path in disk.rglob("*"))
    done = CliRunner().invoke(app, COMMANDS[name].format(disk=disk).split())
    assert "disk-full" in done.stderr, done.output
    assert done.exit_code == 1
    left = sorted(path.name for path in disk.rglob("*") if path.is_file())
    assert [file for file in left if file not in before and file.startswith(".")] == []


def test_a_full_disk_is_recognized() -> None:
    assert is_disk_full(OSError(errno.ENOSPC, "x"))
    assert is_disk_full(RuntimeError("database or disk is full"))
    wrapped = RuntimeError("the writer failed")
    wrapped.__context__ = OSError(errno.ENOSPC, "x")
    assert is_disk_full(wrapped)
    assert not is_disk_full(OSError(errno.EACCES, "x"))
    assert not is_disk_full(None)
