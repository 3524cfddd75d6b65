"""A disk without space: every command that writes says so with one code, and leaves nothing incomplete behind."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from irsim.common.files import is_disk_full
from tests.disks import assert_said_and_nothing_left, disk, here

__all__ = ["disk", "here"]

COMMANDS = {
    "new": "new maze -o {disk}/new.yaml",
    "picture": "render room.yaml -o {disk}/picture.png",
    "svg": "render room.yaml -o {disk}/picture.svg",
    "strip": "render room.yaml --strip 3 -o {disk}/strip.png",
    "gif": "render room.yaml --step 60 -o {disk}/film.gif",
    "apng": "render room.yaml --step 60 -o {disk}/film.apng",
    "film": "render room.yaml --step 60 -o {disk}/film.mp4",
    "film of a run": "render last -o {disk}/film.mp4",
    "run --export": "run room.yaml --export {disk}/run.csv",
    "csv": "export last --to csv -o {disk}/run.csv",
    "npz": "export last --to npz -o {disk}/run.npz",
    "sdf": "export last --to sdf -o {disk}/run.sdf",
    "mjcf": "export last --to mjcf -o {disk}/run.xml",
    "openscenario": "export last --to openscenario -o {disk}/run.xosc",
    "isaac_people": "export last --to isaac_people -o {disk}/people.txt",
    "poses": "export last --to poses -o {disk}/poses.jsonl",
    "colmap": "export last --to colmap -o {disk}/colmap",
    "nerfstudio": "export last --to nerfstudio -o {disk}/nerfstudio",
    "map": "map import hall.yaml -o {disk}/hall.yaml",
    "map for ROS": "map import hall.yaml -o {disk}/hall.yaml --ros-map {disk}/ros.yaml",
    "map export": "map export mapped.yaml -o {disk}/ros.yaml",
    "pedestrians": "bridge import-pedestrians walk.txt -o {disk}/walk.yaml",
    "pedestrians in a scene": "bridge import-pedestrians walk.txt --into room.yaml -o {disk}/walk.yaml",
    "suite of pedestrians": "bridge import-pedestrians walk.txt --write-suite {disk}/walk.yaml",
    "schema": "schema -o {disk}/schema.json",
    "replay": "replay last -o {disk}/replay.html",
}
KEPT = {
    "record": "run room.yaml --record-to {disk}/run",
    "benchmark": "benchmark room.yaml --seeds 2 --workers 1 -o {disk}/benchmark",
}
"""Commands that keep what they had written when the disk was full."""


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.usefixtures("here")
def test_a_full_disk_is_said_and_nothing_is_left(name: str, disk: Path) -> None:
    assert_said_and_nothing_left(COMMANDS[name], disk)


@pytest.mark.parametrize("name", KEPT)
@pytest.mark.usefixtures("here")
def test_a_full_disk_is_said_where_a_part_is_kept(name: str, disk: Path) -> None:
    assert_said_and_nothing_left(KEPT[name], disk, hidden_only=True)


@pytest.mark.usefixtures("here")
def test_a_disk_that_fills_while_a_map_is_written_has_neither_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first file fits, the second one does not."""
    from irsim.bridges.maps import writing

    writer, count = writing.create_bytes, [0]

    def once(*names: object, **options: object) -> None:
        count[0] += 1
        if count[0] > 1:
            raise OSError(errno.ENOSPC, "No space left on device", str(names[0]))
        writer(*names, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(writing, "create_bytes", once)
    (tmp_path / "out").mkdir()
    assert_said_and_nothing_left("map export mapped.yaml -o {disk}/ros.yaml", tmp_path / "out")
    assert count == [2]


def test_a_full_disk_is_recognized() -> None:
    assert is_disk_full(OSError(errno.ENOSPC, "x"))
    assert is_disk_full(RuntimeError("database or disk is full"))
    wrapped = RuntimeError("the writer failed")
    wrapped.__context__ = OSError(errno.ENOSPC, "x")
    assert is_disk_full(wrapped)
    assert not is_disk_full(OSError(errno.EACCES, "x"))
    assert not is_disk_full(None)
