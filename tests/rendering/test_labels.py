"""Labels do not cover each other, in any picture, and names stand at the things that they name."""

from __future__ import annotations

import io
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.transforms import Bbox
from PIL import Image

from irsim.api.take_snapshot import snapshot
from irsim.bundled.templates import scenario_file
from irsim.common.text import metres
from irsim.graphics.figure.figure import SceneFigure, fitting_size
from irsim.graphics.scene.labels import free_places, leader
from irsim.graphics.scene.scene import Label, Scene
from irsim.rendering import strip
from irsim.rendering.snapshot import default_title, legible_scene
from irsim.simulation.simulation import Simulation
from tests.env.driving import Make

VIEW = np.array([0.0, 0.0, 600.0, 600.0])
NOTHING = np.empty((0, 4))
WIDTH, HEIGHT = 30.0, 12.0


def boxes_of(points: Any) -> np.ndarray:
    low = np.asarray(points, dtype=float).reshape(-1, 2) + np.array([-10.0, 10.0])
    return np.concatenate([low, low + np.array([WIDTH, HEIGHT])], axis=1)


def overlapping(boxes: Any) -> list[tuple[int, int]]:
    pairs = combinations(range(len(boxes)), 2)
    return [(i, j) for i, j in pairs if (boxes[i][:2] < boxes[j][2:]).all() and (boxes[j][:2] < boxes[i][2:]).all()]


def placed(points: Any, bodies: Any = NOTHING, walls: Any = NOTHING) -> np.ndarray:
    boxes, middle = boxes_of(points), np.asarray(points, dtype=float).reshape(-1, 2)
    things = np.concatenate([middle - 10.0, middle + 10.0], axis=1)
    moves = free_places(boxes, things, VIEW, lambda: (np.asarray(bodies, dtype=float), np.asarray(walls, dtype=float)))
    return boxes + np.concatenate([moves, moves], axis=1)


def test_labels_that_cover_nothing_stay_and_the_second_of_two_moves_aside() -> None:
    points = [(100, 100), (200, 100), (100, 200)]
    assert (placed(points) == boxes_of(points)).all()
    boxes = placed([(100, 100), (100, 100)])
    assert (boxes[0] == boxes_of([(100, 100)])[0]).all()
    assert not overlapping(boxes)


def test_labels_keep_off_bodies_where_they_can() -> None:
    body = [90.0, 105.0, 130.0, 125.0]
    assert not overlapping([*placed([(100, 100)], [body]), np.array(body)])


def test_labels_stay_inside_of_the_picture() -> None:
    boxes = placed([(0, 0), (600, 600), (0, 600), (600, 0), (600, 600)])
    assert (boxes[:, :2] >= 0).all()
    assert (boxes[:, 2:] <= 600).all()
    assert not overlapping(boxes)


def test_a_label_moves_no_farther_than_it_must() -> None:
    above = [80.0, 110.5, 160.0, 120.0]
    box = placed([(100, 100)], [above])[0]
    assert not overlapping([box, np.array(above)])
    assert box.tolist() == [112.0, 94.0, 142.0, 106.0]  # right beside the thing, at its height


def test_labels_keep_off_walls_but_not_off_the_room_around_their_thing() -> None:
    wall, room = [0.0, 112.0, 600.0, 118.0], [0.0, 0.0, 600.0, 600.0]
    assert not overlapping([placed([(100, 100)], walls=[wall])[0], np.array(wall)])
    assert (placed([(100, 100)], walls=[room]) == boxes_of([(100, 100)])).all()


def test_only_a_label_away_from_its_thing_has_a_line_to_it() -> None:
    thing = np.array([90.0, 90.0, 110.0, 110.0])
    assert leader(np.array([112.0, 94.0, 142.0, 106.0]), thing) is None
    assert leader(np.array([90.0, 140.0, 120.0, 152.0]), thing).tolist() == [[100.0, 140.0], [100.0, 110.0]]


@given(st.lists(st.tuples(st.integers(50, 550), st.integers(50, 550)), min_size=1, max_size=12))
def test_a_dozen_labels_always_find_room(points: list[tuple[int, int]]) -> None:
    boxes = placed(points)
    assert len(overlapping(boxes)) <= max(0, len(points) - 6)  # many at one place
    assert (placed(points) == boxes).all()


CLOSE = """
robot:
  number: 3
  kinematics: {name: diff}
  state: [[3, 3, 0], [6, 6, 0], [6.2, 6.1, 0]]
  goal: [[3, 3, 0], [6.1, 6, 0], [6.3, 6.2, 0]]
  shape: {name: circle, radius: 0.3}
  plot: {show_text: true, show_goal: true, show_goal_text: true}
"""


def boxes_in(figure: Any, ax: Any) -> dict[str, Bbox]:
    """Boxes of the texts that a drawn figure shows [pixels]."""
    renderer = figure.canvas.get_renderer()
    shown = [text for text in ax.texts if text.get_visible() and text.get_text()]
    return {text.get_text(): text.get_window_extent(renderer) for text in shown}


def shown_boxes(env: Any) -> dict[str, Bbox]:
    plot = env._env_plot
    plot.frame()
    return boxes_in(plot.fig, plot.ax)


def snapshot_figure(scene: Scene, pictures: Any) -> SceneFigure:
    x0, x1, y0, y1 = scene.extent
    figure = SceneFigure(fitting_size(x1 - x0, y1 - y0, 600, 100), 100, pictures=pictures, halo=True)
    figure.show(scene, "0.00 s")
    figure.pixels(tight=False)
    return figure


def check_apart(boxes: dict[str, Bbox]) -> None:
    for one, other in combinations(boxes.values(), 2):
        assert Bbox.intersection(one, other) is None or min(Bbox.intersection(one, other).size) < 1.0


def test_a_robot_on_its_goal_can_be_read(make: Make) -> None:
    boxes = shown_boxes(make(CLOSE))
    assert set(boxes) == {"r0", "r1", "r2", "G-r0", "G-r1", "G-r2"}
    check_apart(boxes)


def test_labels_are_where_they_were_asked_for(make: Make) -> None:
    env = make("robot: {kinematics: {name: diff}, state: [3, 3, 0], plot: {show_text: true, text_position: [1, 0.5]}}")
    box = shown_boxes(env)["r0"]
    assert box.x0 == pytest.approx(env._env_plot.ax.transData.transform((4, 3.5))[0], abs=2.0)


def test_walls_round_the_world_have_no_label(make: Make) -> None:
    env = make("world: {boundary: walls}\nobstacle: {state: [5, 5, 0], shape: {name: circle, radius: 0.3}}")
    env.render(mode="all", show_text=True)
    assert set(shown_boxes(env)) == {"o0"}


FLAT = """
world: {{width: {width}, height: {height}, boundary: walls}}
robot:
  - {{name: eastbound, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.25}}, state: {a}, goal: {b}}}
  - {{name: westbound, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.25}}, state: {b}, goal: {a}}}
obstacle: {{name: crate, shape: {{name: rectangle, length: 0.5, width: 0.5}}, state: {c}}}
"""


@pytest.mark.parametrize(
    ("places", "size"),
    [
        ({"a": [1, 1, 0], "b": [39, 1, 0], "c": [20, 0.4, 0], "width": 40, "height": 2}, (40, 8)),
        ({"a": [1, 1, 0], "b": [1, 39, 0], "c": [0.4, 20, 0], "width": 2, "height": 40}, (10, 40)),
    ],
    ids=["flat", "narrow"],
)
def test_names_in_a_very_flat_world_can_be_read(make: Make, places: dict[str, Any], size: tuple[int, int]) -> None:
    scene, pictures = legible_scene(make(FLAT.format(**places)).simulation)
    x0, x1, y0, y1 = scene.extent
    assert (x1 - x0, y1 - y0) == pytest.approx(size)
    figure = snapshot_figure(scene, pictures)
    boxes = boxes_in(figure.figure, figure.ax)
    assert {"eastbound", "westbound", "G-eastbound", "G-westbound", "crate"} <= set(boxes)
    check_apart(boxes)


def test_names_in_a_flat_corridor_stand_at_their_bodies(make: Make) -> None:
    scene, pictures = legible_scene(make(scenario_file("pedestrian-corridor").read_text()).simulation)
    figure = snapshot_figure(scene, pictures)
    boxes = boxes_in(figure.figure, figure.ax)
    for label in scene.labels:
        if label.part == "name" and len(label.text) == 2:  # o1 to o6, people of radius 0.2 m
            x, y = figure.ax.transData.transform(label.anchor)
            box = boxes[label.text]
            assert max(box.x0 - x, x - box.x1, box.y0 - y, y - box.y1) < 12, label.text


# names: the user's, at the things that they name
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


def snapshot_labels(env: Any, **keys: Any) -> dict[str, Label]:
    return labels_of(legible_scene(env.simulation, **keys)[0])


def figure_labels(env: Any, **overrides: Any) -> dict[str, Label]:
    return labels_of(env._env_plot._builder.build(overrides={"show_text": True, **overrides}))


def test_pictures_show_the_names_that_the_user_gave(make: Make) -> None:
    names = {"nurse", "r1", "west wing", "visitor", "counter", "G-nurse", "G-r1"}
    assert names <= set(snapshot_labels(make(SCENE)))
    robots = snapshot(text=SCENE, draw=False).robots
    assert [(robot.name, robot.label) for robot in robots] == [("nurse", "nurse"), ("robot_1", "r1")]


def test_a_long_name_is_cut(make: Make) -> None:
    assert max(map(len, snapshot_labels(make(SCENE.replace("nurse", "n" * 100))))) < 40


def test_the_name_of_a_line_stands_where_the_picture_shows_it(make: Make) -> None:
    env = make(SCENE)
    for labels in (snapshot_labels(env), figure_labels(env)):
        assert labels["west wing"].anchor == pytest.approx((6.5, 2.2))
    assert snapshot_labels(env, region=[3, 0, 5, 2])["west wing"].anchor == pytest.approx((4, 1.5))
    assert "west wing" not in snapshot_labels(env, region=[5, 3, 6, 4])
    moved = figure_labels(env, text_position=[1, 1])["west wing"]
    assert (moved.x, moved.y) == (1, 1), "a position that the user gave holds for lines too"


def test_the_name_of_a_compound_stands_on_its_edge(make: Make) -> None:
    x, y = snapshot_labels(make(SCENE))["counter"].anchor
    assert y == pytest.approx(8.35)
    assert 6.75 <= x <= 9.25


def test_names_of_turned_rectangles_and_polygons_stand_at_the_thing_in_figures_too(make: Make) -> None:
    names = figure_labels(
        make("""
world: {width: 20, height: 10}
obstacle:
  - {name: turned, shape: {name: rectangle, length: 8, width: 0.4}, state: [5, 5, 1.5708]}
  - {name: away, shape: {name: polygon, vertices: [[12, 6], [15, 6], [15, 8]]}, state: [0, 0, 0]}
""")
    )
    assert (names["turned"].x, names["turned"].y) == pytest.approx((4.8, 9.1), abs=1e-3)
    assert (names["away"].x, names["away"].y) == pytest.approx((12, 8.1))
    assert names["away"].anchor == pytest.approx((13.5, 7))


UNTITLED = SCENE.replace("plot: {title: Evening shift}", "plot: {}")


@pytest.mark.parametrize(("text", "title"), [(SCENE, "Evening shift, 0.00 s"), (UNTITLED, "0.00 s")])
def test_snapshots_have_the_title_of_the_scenario(make: Make, text: str, title: str) -> None:
    simulation = make(text).simulation
    assert default_title(simulation, legible_scene(simulation)[0]) == title


def test_strips_have_the_title_of_the_scenario_and_keep_their_size() -> None:
    titled, untitled = (snapshot(text=text, strip=4, steps=8, size=500) for text in (SCENE, UNTITLED))
    assert max(titled.size) <= 500
    above = [Image.open(io.BytesIO(result.png)).convert("L").crop((60, 0, 100, 18)) for result in (titled, untitled)]
    assert above[0].getextrema()[0] < 128 < above[1].getextrema()[0]


def test_strips_show_goals_and_paths_of_everybody_who_moves(monkeypatch: pytest.MonkeyPatch) -> None:
    scenes: list[Scene] = []

    def simplify(scene: Scene, simulation: Simulation, *, first: bool) -> None:
        original(scene, simulation, first=first)
        scenes.append(scene)

    original = strip._simplify
    monkeypatch.setattr(strip, "_simplify", simplify)
    snapshot(text=SCENE, strip=2, steps=20, style="classic")
    for part in ("goal", "trajectory"):
        assert {mark.object for mark in scenes[1].marks if mark.part == part} == {0, 1, 3}


@pytest.mark.parametrize(
    ("length", "text"),
    [(0.999, "1 m"), (0.9994, "1 m"), (1.0, "1 m"), (2.349, "2.35 m"), (12.0, "12 m"), (0.083, "0.083 m"), (0, "0 m")],
)
def test_lengths_are_rounded_to_the_centimetre(length: float, text: str) -> None:
    assert metres(length) == text
