"""Bodies as markers and maps as grids, live and of recorded runs, without the libraries of ROS."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

import irsim
from irsim.bridges.export.formats import _ros_run
from irsim.bridges.ros.markers import body_markers
from irsim.objects.describe import describe_scene

SCENE = """
world: {width: 4, height: 2, obstacle_map: {name: ros, path: map.yaml}}
robot: {name: rover, kinematics: {name: omni}, shape: {name: circle, radius: 0.2, center: [0.1, 0]},
  state: [1, 0.5, 1.5707963], goal: [3, 0.5], color: red}
obstacle:
  - {shape: {name: circle, radius: 0.3, center: [0.5, 0]}, state: [3, 0.5, 1.5707963], color: blue}
  - {shape: {name: linestring, vertices: [[0, 0], [1, 0], [1, 0.5]]}, state: [0, 1, 0]}
  - {shape: {name: polygon, vertices: [[0, 0], [1, 0], [1, 0.5]]}, state: [2, 1, 0]}
"""


class Plain:
    """Makes messages that only hold what they were made of."""

    def __call__(self, package: str, name: str) -> Any:
        return lambda *given, **fields: SimpleNamespace(given=given, **fields)

    def header(self, stamp: int, frame: str) -> str:
        return frame

    def pose(self, x: float, y: float, heading: float) -> Any:
        return SimpleNamespace(at=[x, y, heading], position=SimpleNamespace(z=0.0))

    def vector(self, x: float, y: float, z: float) -> Any:
        return SimpleNamespace(x=x, y=y, z=z)

    def points(self, rows: Any) -> list[list[float]]:
        return np.asarray(rows).tolist()

    def grid(self, stamp: int, frame: str, side: float, origin: Any, levels: Any) -> Any:
        return SimpleNamespace(frame=frame, side=side, origin=origin, levels=levels)


@pytest.fixture
def env(tmp_path: Any) -> irsim.Env:
    levels = np.array([[0, 0, 100, 0], [0, 30, 0, 70]], np.uint8)
    Image.fromarray(levels).save(tmp_path / "map.pgm")
    (tmp_path / "map.yaml").write_text("{image: map.pgm, resolution: 1.0, origin: [0, 0, 0], mode: raw}")
    (tmp_path / "scene.yaml").write_text(SCENE)
    return irsim.make(tmp_path / "scene.yaml", headless=True, log_level="ERROR")


@pytest.mark.parametrize("kind", ["live", "recorded"])
def test_each_body_is_a_marker_where_it_is(env: irsim.Env, kind: str) -> None:
    frames: Any = {"rover": "rover/base"}
    scene: Any = describe_scene(env.simulation)
    made = body_markers(Plain(), scene, frames, "map", united=kind == "recorded")  # type: ignore[arg-type]
    bodies = [marker for marker in made.given[0] if marker.ns == "bodies"]
    rover, disk, line, area = bodies
    assert [marker.type for marker in bodies] == [3, 3, 4, 11]
    assert [marker.header for marker in bodies] == ["rover/base", "map", "map", "map"]
    assert (rover.scale.x, disk.scale.y) == pytest.approx((0.4, 0.6)), "scales are diameters"
    assert rover.pose.at == pytest.approx([0.1, 0, 0]), "in its own frame"
    assert disk.pose.at == pytest.approx([3, 1, 1.5707963], abs=1e-4), "in the world"
    assert rover.color.given == (1, 0, 0, 1)
    assert disk.color.given == (0, 0, 1, 1)
    assert line.points == [[0, 0], [1, 0], [1, 0.5]]
    assert sorted(area.points) == [[0, 0], [1, 0], [1, 0.5]]
    assert [marker.text for marker in made.given[0] if marker.ns == "names"] == ["rover"]


def test_a_grid_keeps_the_levels_of_its_map(env: irsim.Env) -> None:
    grid = _ros_run.occupancy_grid(Plain(), describe_scene(env.simulation), "map")  # type: ignore[arg-type]
    assert (grid.side, grid.origin) == (1, (0, 0))
    assert grid.levels.tolist() == [[0, 0], [30, 0], [0, 100], [70, 0]], "(nx, ny), from below"
