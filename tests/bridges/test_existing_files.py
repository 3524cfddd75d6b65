"""Commands that export or import agree: what exists is replaced with --force only, and missing folders are made."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import Result
from typer.testing import CliRunner

import irsim
from irsim.bridges.export.registry import format_names
from irsim.cli.app import app
from irsim.common.files import TargetError
from irsim.lookup.topics import lookup
from irsim.runs import RunError
from tests.bridges import crowds

SCENE = """
world: {width: 10, height: 10}
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 1]}
obstacle: {kinematics: {name: omni}, state: [8, 8, 0], goal: [8, 2], behavior: {name: dash}}
"""
MAP = "world: {width: 4, height: 4, obstacle_map: {name: perlin, resolution: 0.1, seed: 1}}"
COMMANDS = {
    "export": "export last --to csv -o {folder}/a.csv",
    "export-scene": "bridge export-scene scene.yaml -o {folder}/a.usda",
    "import-pedestrians": "bridge import-pedestrians crowd.txt -o {folder}/a.yaml --write-suite {folder}/b.yaml",
    "map-export": "map export map.yaml -o {folder}/a.yaml",
    "map-import": "map import grid.yaml -o {folder}/a.yaml",
    "new": "new head-on -o {folder}/a.yaml",
    "run": "run scene.yaml --steps 3 --export {folder}/a.csv",
}


@pytest.fixture
def call() -> Callable[[str], Result]:
    Path("scene.yaml").write_text(SCENE)
    Path("map.yaml").write_text(MAP)
    Path("crowd.txt").write_text(crowds.trajnet())
    irsim.run("scene.yaml", seed=1, steps=3, record=True)

    def invoke(command: str) -> Result:
        return CliRunner().invoke(app, command.split())

    assert invoke("map export map.yaml -o grid.yaml").exit_code == 0
    return invoke


@pytest.fixture(params=COMMANDS)
def name(request: pytest.FixtureRequest) -> str:
    if request.param == "export-scene":
        pytest.importorskip("pxr")
    return str(request.param)


def test_files_that_exist_and_folders_that_do_not(call: Callable[[str], Result], name: str) -> None:
    command = COMMANDS[name].format(folder="new/folder")
    first = call(command)
    assert first.exit_code == 0, first.output
    files = {path: path.read_bytes() for path in Path("new/folder").iterdir()}
    assert files
    for path in files:
        path.write_bytes(b"mine")
    refused = call(command)
    assert refused.exit_code == 2, refused.output
    assert "exists" in refused.output
    assert "--force" in refused.output
    assert all(path.read_bytes() == b"mine" for path in files)
    assert sorted(Path("new/folder").iterdir()) == sorted(files), "nothing else is written"
    forced = call(f"{command} --force")
    assert forced.exit_code == 0, forced.output
    assert all(path.read_bytes() != b"mine" for path in files)


def test_names_that_are_no_files(call: Callable[[str], Result], name: str) -> None:
    suffix = COMMANDS[name].split("{folder}/a.")[1].split()[0]
    Path(f"folder/a.{suffix}").mkdir(parents=True)
    command = COMMANDS[name].format(folder="folder")
    for forced in ("", " --force"):
        done = call(command + forced)
        assert done.exit_code in (1, 2)
        assert "is a folder" in done.output, done.output
    done = call(COMMANDS[name].format(folder="scene.yaml"))
    assert done.exit_code in (1, 2)
    assert "is not a folder" in done.output, done.output
    assert Path("scene.yaml").read_text() == SCENE


def test_the_formats_are_described() -> None:
    text = lookup("exports").text
    assert [name for name in format_names() if not re.search(rf"\b{name}\b", text)] == []


def test_exports_from_python(call: Callable[[str], Result]) -> None:
    irsim.export_run("last", "a.csv")
    with pytest.raises(TargetError, match="exists"):
        irsim.export_run("last", "a.csv")
    irsim.export_run("last", "a.csv", overwrite=True)
    with pytest.raises(TargetError, match="exists"):
        irsim.run("scene.yaml", steps=100_000, export="a.csv")
    irsim.run("scene.yaml", steps=3, export="a.csv", overwrite=True)
    Path("cameras").mkdir()
    with pytest.raises((TargetError, RunError), match="not replaced"):
        irsim.export_run("last", "cameras", to="colmap", overwrite=True)
