"""Worlds in SDF, read by the official parser, libsdformat."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import irsim
from irsim.bridges.sdf import SdfWorld
from irsim.objects.describe import describe_scene
from tests.bridges.scenes import recorded
from tests.interop.conftest import with_libsdformat

pytestmark = [pytest.mark.interop, pytest.mark.xdist_group("sdf")]

TEMPLATES = Path(__file__).resolve().parents[2] / "templates"
Parser = Callable[..., subprocess.CompletedProcess[str]]
RUN = """
world: {width: 12, height: 8, boundary: walls, obstacle_map: {name: perlin, resolution: 0.5, fill: 0.1, seed: 9}}
robot:
  - {name: rover, shape: {name: circle, radius: 0.2}, state: [1, 1, 0], goal: [11, 7, 0], kinematics: {name: diff},
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 31, range_max: 5}]}
obstacle:
  - {number: 3, distribution: {name: manual}, shape: {name: circle, radius: 0.2}, kinematics: {name: omni},
     state: [[4, 2, 0], [5, 5, 0], [8, 3, 0]],
     goal: [[8, 6, 0], [2, 5, 0], [8, 7, 0]], behavior: {name: dash}}
  - {shape: {name: polygon, vertices: [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]}, state: [9, 5, 0]}
"""


@pytest.fixture(scope="module")
def parser(tmp_path_factory: pytest.TempPathFactory) -> Parser:
    """The official parser, compiled once."""
    program = with_libsdformat("check_sdf", tmp_path_factory.mktemp("parser"))

    def parse(*files: Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run([str(program), *map(str, files)], capture_output=True, text=True, check=False)

    return parse


def numbers_of(line: str) -> dict[str, int]:
    words = line.split()
    return {word: int(number) for word, number in zip(words[::2], words[1::2], strict=True)}


def test_a_recorded_run_has_no_errors(parser: Parser) -> None:
    irsim.export_run(recorded(RUN, 20), "town", to="sdf")
    done = parser(Path("town/world.sdf"))
    assert done.stderr == ""
    counts = numbers_of(done.stdout)
    assert counts["errors"] == counts["empty"] == 0
    assert (counts["actors"], counts["waypoints"]) == (3, 63)
    assert (counts["lidars"], counts["beams"]) == (1, 31)
    assert counts["models"] == 5  # ground, walls, map, robot, polygon
    assert counts["visuals"] > 20


def test_templates_are_worlds_without_errors(parser: Parser, tmp_path: Path) -> None:
    files = []
    for path in sorted(TEMPLATES.glob("*/scenario.yaml"))[::3]:  # the parser needs 0.7 s for a file of any size
        env = irsim.make(str(path), headless=True, log_level="ERROR")
        text = SdfWorld(describe_scene(env.simulation), {}).write()
        env.end(ending_time=0.0)
        files.append(tmp_path / f"{path.parent.name}.sdf")
        files[-1].write_text(text, encoding="utf-8")
    done = parser(*files)
    assert done.stderr == ""
    assert done.returncode == 0
    counts = [numbers_of(line) for line in done.stdout.splitlines()]
    assert len(counts) == len(files) >= 14
    assert all(one["models"] >= 2 and one["empty"] == 0 for one in counts)
