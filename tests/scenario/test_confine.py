"""Files that a scenario names stay inside the folder its reader is confined to."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from irsim.diagnostics.diagnostic import format_path
from irsim.options.registry import REGISTRIES
from irsim.scenario.limits import Limits
from irsim.scenario.path_confinement import why_outside
from irsim.scenario.read import read
from irsim.scenario.yaml.document import load_path, load_text

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="links and pipes of POSIX")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "root"
    (root / "maps").mkdir(parents=True)
    (root / "maps" / "a.png").write_bytes(b"")
    (tmp_path / "secret.png").write_bytes(b"")
    return root


@pytest.mark.parametrize("name", ["maps/a.png", "./maps/a.png", "maps//a.png", "not-there.png", "a..b", "地图　1.png"])
def test_names_that_lead_downwards_pass(root: Path, name: str) -> None:
    assert why_outside(name, root) is None


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("../secret.png", "leads upwards"),
        ("maps/../../secret.png", "leads upwards"),
        ("maps\\..\\..\\secret.png", "leads upwards"),
        ("/etc/passwd", "absolute"),
        ("C:\\secret.png", "absolute"),
        ("C:secret.png", "absolute"),
        ("\\\\host\\share\\secret.png", "absolute"),
        ("//host/share/secret.png", "absolute"),
        ("~/secret.png", "home"),
        ("~root/secret.png", "home"),
        ("maps/a.png\0", "control character"),
        ("maps/\u202egnp.a", "control character"),
        ("maps/nul.png", "device"),
        ("maps/" + "x" * 5000, "cannot be followed"),
    ],
)
def test_names_that_lead_elsewhere_do_not(root: Path, name: str, why: str) -> None:
    assert why in str(why_outside(name, root))


@POSIX
def test_links_count_as_what_they_lead_to(root: Path) -> None:
    (root / "inside.png").symlink_to(root / "maps" / "a.png")
    (root / "outside.png").symlink_to(root.parent / "secret.png")
    (root / "folder").symlink_to(root.parent)
    (root / "ring").symlink_to("ring")
    assert why_outside("inside.png", root) is None
    assert "link that leads out" in str(why_outside("outside.png", root))
    assert "link that leads out" in str(why_outside("folder/secret.png", root))
    assert "cannot be followed" in str(why_outside("ring", root))
    assert "cannot be followed" in str(why_outside("ring/a.png", root))


@POSIX
def test_a_pipe_would_be_waited_for(root: Path) -> None:
    os.mkfifo(root / "pipe.png")
    assert "pipe" in str(why_outside("pipe.png", root))


@POSIX
def test_a_root_may_itself_be_a_link(root: Path) -> None:
    link = root.parent / "link"
    link.symlink_to(root)
    assert why_outside("maps/a.png", link) is None


def test_every_file_of_a_scenario_is_looked_at(root: Path) -> None:
    text = (
        "world: {obstacle_map: {name: ros, path: ../map.yaml}}\n"
        "robot:\n  - {number: 2, state: [[1, 1], [5, 5]], description: [car_blue.png, /etc/car.png]}\n"
        "obstacle: {description: ../wall.png}\n"
    )
    lines = {
        format_path(item.path): item.line
        for item in read(load_text(text, limits=Limits(root=str(root)))).errors
        if item.code == "path-outside-workspace"
    }
    assert lines == {"world.obstacle_map.path": 1, "robot[0].description[1]": 3, "obstacle.description": 4}
    assert not [item for item in read(load_text(text)).errors if item.code == "path-outside-workspace"]


@POSIX
def test_names_count_from_the_folder_of_the_scenario_too(root: Path) -> None:
    (root / "maps" / "link.png").symlink_to(root.parent / "secret.png")
    scenario = root / "maps" / "room.yaml"
    scenario.write_text("world: {obstacle_map: link.png}\n", encoding="utf-8")
    errors = read(load_path(scenario, Limits(root=str(root)))).errors
    assert "path-outside-workspace" in [item.code for item in errors]


def test_the_options_that_name_files_are_known() -> None:
    keys = {
        f"{kind}.{name}"
        for kind, registry in REGISTRIES.items()
        for feature in registry.features()
        if feature.origin == "built-in"
        for name in feature.options.model_fields
        if any(word in name for word in ("path", "file", "image", "picture"))
    }
    assert keys == {"map.path", "planner.path_resolution"}
