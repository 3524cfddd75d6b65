"""Zones in pictures: if asked for, and in snapshots."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.api.take_snapshot import snapshot
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Circle, Line, Region
from irsim.graphics.scene.zones import draw_zones
from irsim.scenario.read import read
from tests.env.driving import Make

WORLD = """\
world:
  width: 12
  height: 8
  zones:
    - {{name: door, line: [[5, 3], [5, 5]]}}
    - {{name: kitchen, rectangle: [6, 1, 8, 5], color: red}}
    - {{name: dock, circle: {{center: [10, 4], radius: 1}}}}
    - {{name: clockwise, polygon: [[1, 1], [1, 3], [3, 1]]}}
  plot: {{show_zones: {show}}}
robot: {{kinematics: {{name: diff}}, state: [1, 6, 0], goal: [2, 7]}}
"""


def zones() -> Any:
    return read(WORLD.format(show="false")).scenario.world.zones


def test_each_zone_is_marked_in_its_place_and_color_and_named() -> None:
    drawn = draw_zones(zones(), "#882255", (0, 12, 0, 8))
    of = {label.text: [mark for mark in drawn.marks if mark.object == label.object] for label in drawn.labels}
    assert list(of) == ["door", "kitchen", "dock", "clockwise"]
    line, pointer = of["door"]
    assert isinstance(line.geometry, Line)
    assert line.geometry.points.tolist() == [[5, 3], [5, 5]]
    left, _, right, _ = bounds(pointer.geometry)
    assert left == 5 < right, "the pointer leads from left to right"
    for name, box in {"kitchen": (6, 1, 8, 5), "dock": (9, 3, 11, 5), "clockwise": (1, 1, 3, 3)}.items():
        fill, edge = of[name]
        assert bounds(fill.geometry) == bounds(edge.geometry) == box
        assert fill.fill == edge.stroke.color == ("red" if name == "kitchen" else "#882255")
    assert isinstance(of["dock"][0].geometry, Circle)
    ring = of["clockwise"][0].geometry
    assert isinstance(ring, Region)
    x, y = ring.rings[0].T
    assert x @ np.roll(y, -1) > y @ np.roll(x, -1), "outlines run counter-clockwise"


def test_names_stay_at_the_part_that_the_picture_shows() -> None:
    drawn = draw_zones(zones(), "k", (7, 9, 2, 4))
    name = next(label for label in drawn.labels if label.text == "kitchen")
    assert name.anchor == (7.5, 3.0)


@pytest.mark.parametrize(("show", "names"), [("true", {"door", "kitchen", "dock", "clockwise"}), ("false", set())])
def test_figures_show_them_if_asked(make: Make, show: str, names: set[str]) -> None:
    env = make(WORLD.format(show=show))
    env.render()
    scene, again = env._env_plot.scene(), env._env_plot.scene()
    assert {label.text for label in scene.labels if label.part == "zone"} == names
    marks = [[mark for mark in one.marks if mark.part == "zone"] for one in (scene, again)]
    assert all(a is b for a, b in zip(*marks, strict=True)), "the figure need not draw them again"


def test_a_figure_in_three_dimensions_shows_them(make: Make) -> None:
    env = make(WORLD.format(show="true"), projection="3d")
    env.render()
    assert "kitchen" in {text.get_text() for text in env._env_plot.ax.texts}


def test_snapshots_show_them_unless_other_overlays_are_asked_for() -> None:
    text = WORLD.format(show="false")
    before, _, after = text.partition("  zones:")
    bare = before + "robot:" + after.partition("robot:")[2]

    def png(text: str, overlays: list[str] | None = None) -> bytes:
        return snapshot(text=text, size=300, overlays=overlays).png

    plain = png(text, ["names"])
    assert png(bare, ["names"]) == plain != png(text, ["names", "zones"])
    assert png(bare) != png(text)
