"""A disk without space, for formats that libraries write and bags that they read."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from irsim.cli.app import app
from tests.disks import assert_said_and_nothing_left, disk, here

__all__ = ["disk", "here"]

pytestmark = pytest.mark.interop

COMMANDS = {
    "mcap": "export last --to mcap -o {disk}/run.mcap",
    "rosbag2": "export last --to rosbag2 -o {disk}/bag",
    "parquet": "export last --to parquet -o {disk}/run.parquet",
    "minari": "export last --to minari -o {disk}/room-v0",
    "commonroad": "export last --to commonroad -o {disk}/run.xml",
    "run --export": "run room.yaml --export {disk}/run.mcap",
    "usda": "export last --to usd -o {disk}/run.usda",
    "usdc": "export last --to usd -o {disk}/run.usdc",
    "usdz": "export last --to usd -o {disk}/run.usdz",
    "scene": "bridge export-scene room.yaml -o {disk}/scene.usdz",
    "bag": "bridge import-bag bag -o {disk}/lab.yaml",
}


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.usefixtures("here")
def test_a_full_disk_is_said_and_nothing_is_left(name: str, disk: Path) -> None:
    if name == "bag":
        assert CliRunner().invoke(app, ["export", "last", "--to", "rosbag2", "-o", "bag"]).exit_code == 0
    assert_said_and_nothing_left(COMMANDS[name], disk)


@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz"])
@pytest.mark.usefixtures("here")
def test_a_full_disk_of_temporary_files_is_said(suffix: str, disk: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if not (disk / "filler").exists():
        pytest.skip("no disk can be mounted here")
    (disk / "filler").unlink()
    (disk / "folder").mkdir()
    (disk / "filler").write_bytes(b"x" * 4096)
    monkeypatch.setattr("tempfile.tempdir", str(disk))
    assert_said_and_nothing_left(f"export last --to usd -o run{suffix}", disk)
    assert not Path(f"run{suffix}").exists()
