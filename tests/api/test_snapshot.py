"""A small picture of one moment, and in words what is in it."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from PIL import Image

import irsim
from irsim.api import snapshot
from irsim.diagnostics.errors import IrsimError, OverLimitError
from irsim.graphics.scene.theme import LIGHT
from irsim.options.colors import rgb
from irsim.scenario.limits import Limits

SCENE = """\
world: {width: 8, height: 4, offset: [-1, 0]}
robot:
  - {name: rover, kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 2], goal: [5, 2],
     behavior: {name: dash}, sensors: [{name: lidar2d, number: 20, range_max: 2}]}
obstacle:
  - {name: crate, state: [6, 3], shape: {name: rectangle, length: 1, width: 0.5}}
"""


def empty(png: bytes) -> int:
    """Pixels of the commonest color."""
    with Image.open(io.BytesIO(png)) as image:
        assert image.format == "PNG"
        assert image.mode == "P"
        return int(max(count for count, _ in image.getcolors() or []))


def test_start() -> None:
    result = snapshot(text=SCENE, seed=1)
    assert (result.steps, result.sim_time, result.obstacles) == (0, 0.0, 1)
    assert result.extent == (-1, 7, 0, 4)
    robot = result.robots[0]
    assert (robot.name, robot.label, robot.pose, robot.goal) == ("rover", "rover", (1, 2, 0), (5, 2))
    assert robot.status == "under way"
    assert max(result.size) == 600
    with Image.open(io.BytesIO(result.png)) as image:
        assert image.size == result.size
    assert len(result.png) < 40_000
    assert "png" not in result.model_dump()


def test_later_and_to_the_end() -> None:
    assert snapshot(text=SCENE, steps=10, draw=False).robots[0].pose[0] == pytest.approx(2)
    end = snapshot(text=SCENE, steps=None, draw=False)
    assert end.robots[0].status == "arrived"
    assert end.png == b""


def test_a_part_of_the_world() -> None:
    part = snapshot(text=SCENE, region=[4, 1, 7, 4], size=400, seed=1)
    assert "--size 400 --region 4 1 7 4 -o" in part.reproduce
    assert part.size[0] == pytest.approx(part.size[1], abs=60)
    assert part.extent == snapshot(text=SCENE, draw=False).extent, "the world stays the same"
    with Image.open(io.BytesIO(part.png)) as image:
        still = tuple(round(255 * level) for level in rgb(LIGHT.still))
        crate = sum(count for count, color in image.convert("RGB").getcolors() or [] if color == still)
        assert crate > 2 * 50 * 25, "the crate is three times as large"


@pytest.mark.parametrize("region", [[0, 0, 1], [2, 0, 1, 1], [0, 0, 0, 1], [0, 0, float("inf"), 1], [float("nan")] * 4])
def test_no_part_of_any_world(region: list[float]) -> None:
    with pytest.raises(IrsimError, match="x_min, y_min, x_max, y_max"):
        snapshot(text=SCENE, region=region)


def test_overlays_can_be_left_out() -> None:
    bare = snapshot(text=SCENE, size=300, overlays=[])
    full = snapshot(text=SCENE, size=300, overlays=["names", "goals", "paths", "sensors"])
    assert max(bare.size) == 300
    assert empty(bare.png) > empty(full.png) + 100


def test_limits_hold() -> None:
    with pytest.raises(OverLimitError):
        snapshot(text=SCENE, steps=50, limits=Limits(steps=49))


def test_nothing_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    snapshot(text=SCENE)
    assert list(tmp_path.iterdir()) == []


def test_walls_and_a_map_are_no_obstacles() -> None:
    walled = snapshot(text=SCENE.replace("offset: [-1, 0]", "offset: [-1, 0], boundary: walls"), draw=False)
    assert (walled.obstacles, walled.contents) == (1, "1 obstacle, walls round the world")
    report = irsim.validate(text="world: {width: 50, height: 50, obstacle_map: cave.png}\n")
    assert "no obstacles, a map of 500 x 500 cells (25 % occupied)" in report.summary
    assert report.counts["obstacles"] == 0
    assert report.counts["map_occupied"] == pytest.approx(500 * 500 / 4, rel=0.03)


def test_moving_obstacles_are_told() -> None:
    walker = SCENE + (
        "  - {name: walker, kinematics: {name: omni}, state: [2, 1], goal: [2, 3], shape: {name: circle},"
        " behavior: {name: dash}}\n"
    )
    (mover,) = snapshot(text=walker, steps=5, draw=False).moving
    assert mover.name == "walker"
    assert mover.velocity == pytest.approx((0, 1), abs=1e-6)
    assert mover.pose[:2] == pytest.approx((2, 1.5), abs=1e-6)
