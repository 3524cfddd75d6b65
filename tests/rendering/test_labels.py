"""Labels do not cover each other, in any picture."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.transforms import Bbox

from irsim.bundled.templates import scenario_file
from irsim.graphics.figure.figure import SceneFigure, fitting_size
from irsim.graphics.scene.labels import free_places, leader
from irsim.rendering.snapshot import legible_scene

Make = Callable[..., Any]
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


def test_labels_that_cover_nothing_stay() -> None:
    points = [(100, 100), (200, 100), (100, 200)]
    assert (placed(points) == boxes_of(points)).all()


def test_the_second_of_two_at_one_place_moves_aside() -> None:
    boxes = placed([(100, 100), (100, 100)])
    assert (boxes[0] == boxes_of([(100, 100)])[0]).all()
    assert not overlapping(boxes)


def test_labels_keep_off_bodies_where_they_can() -> None:
    body = [90.0, 105.0, 130.0, 125.0]
    boxes = placed([(100, 100)], [body])
    assert not overlapping([boxes[0], np.array(body)])


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
    line = leader(np.array([90.0, 140.0, 120.0, 152.0]), thing)
    assert line is not None
    assert line.tolist() == [[100.0, 140.0], [100.0, 110.0]]


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


def shown_boxes(env: Any) -> dict[str, Bbox]:
    plot = env._env_plot
    plot.frame()
    renderer = plot.fig.canvas.get_renderer()
    return {text.get_text(): text.get_window_extent(renderer) for text in plot.ax.texts if text.get_visible()}


def test_a_robot_on_its_goal_can_be_read(make: Make) -> None:
    boxes = shown_boxes(make(CLOSE))
    assert set(boxes) == {"r0", "r1", "r2", "G-r0", "G-r1", "G-r2"}
    for one, other in combinations(boxes.values(), 2):
        assert Bbox.intersection(one, other) is None or min(Bbox.intersection(one, other).size) < 1.0


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


@pytest.mark.parametrize("turned", [False, True])
def test_names_in_a_very_flat_world_can_be_read(make: Make, turned: bool) -> None:
    places = {"a": [1, 1, 0], "b": [39, 1, 0], "c": [20, 0.4, 0], "width": 40, "height": 2}
    if turned:
        places = {"a": [1, 1, 0], "b": [1, 39, 0], "c": [0.4, 20, 0], "width": 2, "height": 40}
    scene, pictures = legible_scene(make(FLAT.format(**places)).simulation)
    x0, x1, y0, y1 = scene.extent
    assert (x1 - x0, y1 - y0) == pytest.approx((10, 40) if turned else (40, 8))
    figure = SceneFigure(fitting_size(x1 - x0, y1 - y0, 600, 100), 100, pictures=pictures, halo=True)
    figure.show(scene, "0.00 s")
    figure.pixels(tight=False)
    renderer = figure.figure.canvas.get_renderer()
    boxes = {t.get_text(): t.get_window_extent(renderer) for t in figure.ax.texts if t.get_visible() and t.get_text()}
    assert {"eastbound", "westbound", "G-eastbound", "G-westbound", "crate"} <= set(boxes)
    for one, other in combinations(boxes.values(), 2):
        assert Bbox.intersection(one, other) is None or min(Bbox.intersection(one, other).size) < 1.0


def test_names_in_a_flat_corridor_stand_at_their_bodies(make: Make) -> None:
    simulation = make(scenario_file("pedestrian-corridor").read_text()).simulation
    scene, pictures = legible_scene(simulation)
    x0, x1, y0, y1 = scene.extent
    figure = SceneFigure(fitting_size(x1 - x0, y1 - y0, 600, 100), 100, pictures=pictures, halo=True)
    figure.show(scene, "0.00 s")
    figure.pixels(tight=False)
    renderer = figure.figure.canvas.get_renderer()
    boxes = {t.get_text(): t.get_window_extent(renderer) for t in figure.ax.texts if t.get_visible()}
    for label in scene.labels:
        if label.part == "name" and len(label.text) == 2:  # o1 to o6, people of radius 0.2 m
            x, y = figure.ax.transData.transform(label.anchor)
            box = boxes[label.text]
            away = max(box.x0 - x, x - box.x1, box.y0 - y, y - box.y1)
            assert away < 12, label.text
