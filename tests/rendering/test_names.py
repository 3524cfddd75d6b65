"""Names in pictures are the user's, at the things that they name."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import pytest
from PIL import Image

from irsim.api.take_snapshot import snapshot
from irsim.common.text import metres
from irsim.graphics.scene.scene import Label, Scene
from irsim.rendering import strip
from irsim.rendering.snapshot import default_title, legible_scene
from irsim.simulation.simulation import Simulation

Make = Callable[..., Any]

SCENE = """
world: {width: 12, height: 10, plot: {title: Evening shift}}
robot:
  - {name: nurse, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [2, 3, 0], goal: [10, 3, 0],
     behavior: {name: dash}}
  - {kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [2, 6, 0], goal: [10, 6, 0],
     behavior: {name: dash}}
obstacle:
  - {name: west wing, state: [0, 0, 0], shape: {name: linestring, vertices: [[4, 1], [4, 2.2], [9, 2.2], [9, 1]]}}
  - {name: visitor, kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, state: [10, 9, 0], goal: [2, 9, 0],
     behavior: {name: dash}}
  - name: counter
    state: [8, 7.2, 0]
    shape:
      name: compound
      parts:
        - {name: rectangle, length: 2.5, width: 0.3, pose: [0, 1, 0]}
        - {name: rectangle, length: 0.3, width: 2, pose: [-1.1, 0, 0]}
"""


def labels_of(scene: Scene) -> dict[str, Label]:
    return {label.text: label for label in scene.labels}


def test_pictures_show_the_names_that_the_user_gave(make: Make) -> None:
    scene, _ = legible_scene(make(SCENE).simulation)
    assert {"nurse", "r1", "west wing", "visitor", "counter", "G-nurse", "G-r1"} <= set(labels_of(scene))
    robots = snapshot(text=SCENE, draw=False).robots
    assert [(robot.name, robot.label) for robot in robots] == [("nurse", "nurse"), ("robot_1", "r1")]


def test_a_long_name_is_cut(make: Make) -> None:
    scene, _ = legible_scene(make(SCENE.replace("nurse", "n" * 100)).simulation)
    assert max(map(len, labels_of(scene))) < 40


def test_the_name_of_a_line_stands_at_the_line(make: Make) -> None:
    env = make(SCENE)
    scene, _ = legible_scene(env.simulation)
    assert labels_of(scene)["west wing"].anchor == pytest.approx((6.5, 2.2))
    plain = env._env_plot._builder.build(overrides={"show_text": True})
    assert labels_of(plain)["west wing"].anchor == pytest.approx((6.5, 2.2))


def test_the_name_of_a_line_stands_where_the_picture_shows_it(make: Make) -> None:
    scene, _ = legible_scene(make(SCENE).simulation, region=[3, 0, 5, 2])
    assert labels_of(scene)["west wing"].anchor == pytest.approx((4, 1.5))
    elsewhere, _ = legible_scene(make(SCENE).simulation, region=[5, 3, 6, 4])
    assert "west wing" not in labels_of(elsewhere)


def test_the_name_of_a_compound_stands_on_its_edge(make: Make) -> None:
    scene, _ = legible_scene(make(SCENE).simulation)
    x, y = labels_of(scene)["counter"].anchor
    assert y == pytest.approx(8.35)
    assert 6.75 <= x <= 9.25


def test_names_of_turned_rectangles_and_polygons_stand_at_the_thing_in_figures_too(make: Make) -> None:
    env = make("""
world: {width: 20, height: 10}
obstacle:
  - {name: turned, shape: {name: rectangle, length: 8, width: 0.4}, state: [5, 5, 1.5708]}
  - {name: away, shape: {name: polygon, vertices: [[12, 6], [15, 6], [15, 8]]}, state: [0, 0, 0]}
""")
    names = labels_of(env._env_plot._builder.build(overrides={"show_text": True}))
    assert (names["turned"].x, names["turned"].y) == pytest.approx((4.8, 9.1), abs=1e-3)
    assert (names["away"].x, names["away"].y) == pytest.approx((12, 8.1))
    assert names["away"].anchor == pytest.approx((13.5, 7))


def test_a_position_that_the_user_gave_holds_for_lines_too(make: Make) -> None:
    env = make(SCENE)
    plain = env._env_plot._builder.build(overrides={"show_text": True, "text_position": [1, 1]})
    assert (labels_of(plain)["west wing"].x, labels_of(plain)["west wing"].y) == (1, 1)


def test_snapshots_have_the_title_of_the_scenario(make: Make) -> None:
    simulation = make(SCENE).simulation
    scene, _ = legible_scene(simulation)
    assert default_title(simulation, scene) == "Evening shift, 0.00 s"
    untitled = make(SCENE.replace("plot: {title: Evening shift}", "plot: {}")).simulation
    assert default_title(untitled, scene) == "0.00 s"


def test_strips_have_the_title_of_the_scenario_and_keep_their_size() -> None:
    titled = snapshot(text=SCENE, strip=4, steps=8, size=500)
    untitled = snapshot(text=SCENE.replace("plot: {title: Evening shift}", "plot: {}"), strip=4, steps=8, size=500)
    assert max(titled.size) <= 500
    above = [Image.open(io.BytesIO(result.png)).convert("L").crop((200, 0, 245, 18)) for result in (titled, untitled)]
    assert above[0].getextrema()[0] < 128 < above[1].getextrema()[0]


def test_strips_show_goals_and_paths_of_everybody_who_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    scenes: list[Scene] = []

    def simplify(scene: Scene, simulation: Simulation, *, first: bool) -> None:
        original(scene, simulation, first=first)
        scenes.append(scene)

    original = strip._simplify
    monkeypatch.setattr(strip, "_simplify", simplify)
    snapshot(text=SCENE, strip=2, steps=20)
    for part in ("goal", "trajectory"):
        assert {mark.object for mark in scenes[1].marks if mark.part == part} == {0, 1, 3}


@pytest.mark.parametrize(
    ("length", "text"),
    [(0.999, "1 m"), (0.9994, "1 m"), (1.0, "1 m"), (2.349, "2.35 m"), (12.0, "12 m"), (0.083, "0.083 m"), (0, "0 m")],
)
def test_lengths_are_rounded_to_the_centimetre(length: float, text: str) -> None:
    assert metres(length) == text
