"""Clearance and planned paths in snapshots."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from shapely import Point, Polygon, union_all
from shapely.affinity import rotate, translate
from shapely.geometry.base import BaseGeometry

from irsim.api import snapshot
from irsim.api.overlays import footprint_of, requested_plans
from irsim.bundled.templates import scenario_file
from irsim.graphics.scene.scene import Line, Region, Scene
from irsim.rendering import SceneBuilder
from irsim.rendering.clearance_map import FreeSpace, draw_clearance
from irsim.rendering.planned_paths import plan_paths
from tests.env.driving import Make

ROOM = """\
world: {{width: 10, height: 6, boundary: walls}}
robot:
  - {{name: rover, kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, state: [1, 3], goal: {goal},
     behavior: {{name: {behavior}}}}}
obstacle:
  - {{state: [5, {middle}], shape: {{name: rectangle, length: 0.4, width: 4}}}}
"""
EMPTY = "world: {width: 5, height: 5}\nrobot: [{state: [1, 1], goal: [4, 1]}]\n"


def room(goal: str = "[9, 3]", behavior: str = "dash", middle: float = 2.0) -> str:
    return ROOM.format(goal=goal, behavior=behavior, middle=middle)


def plan(text: str) -> dict[str, object]:
    (path,) = snapshot(text=text, overlays=["plan"], draw=False).plans
    return path.model_dump()


def scene_of(env: Any) -> Scene:
    scene = SceneBuilder(env.simulation).build()
    draw_clearance(scene, env.simulation)
    return scene


def test_shortest_way_of_who_does_not_plan() -> None:
    path = plan(room())
    assert (path["own"], path["lost"]) == (False, None)
    assert path["length"] == pytest.approx(2 * math.hypot(4, 1), abs=0.5)
    assert 0 <= float(str(path["margin"])) < 0.1


def test_own_plan_of_follow_is_the_one_that_it_drives() -> None:
    text = room(behavior="follow")
    first, later = (snapshot(text=text, steps=n, overlays=["plan"], draw=False).plans[0] for n in (0, 1))
    assert first == later
    assert first.own
    assert first.margin > 0


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        (room(behavior="dash").replace("width: 4}", "width: 8}"), (9, 3)),
        (room(behavior="follow").replace("width: 4}", "width: 8}"), (9, 3)),
        (room("[5, 2]"), (5, 2)),
        (room("[5.3, 2]"), (5.3, 2)),
    ],
    ids=["a wall, dash", "a wall, follow", "goal in a thing", "goal beside a thing"],
)
def test_a_goal_without_path_is_lost(text: str, goal: tuple[float, float]) -> None:
    path = plan(text)
    assert (path["lost"], path["length"]) == (goal, 0)


def test_ways_end_at_the_goal() -> None:
    text = room("[9.07, 3.03]").replace("width: 10, height: 6", "width: 90, height: 90")
    start, goal, corner = (1, 3), (9.07, 3.03), (5, 4.3)
    assert plan(text)["length"] == pytest.approx(math.dist(start, corner) + math.dist(corner, goal), abs=0.5)


def test_several_goals() -> None:
    text = room().replace("goal: [9, 3]", "waypoints: [[1, 5], [9, 5], [9, 1]]")
    assert plan(text)["length"] == pytest.approx(2 + 8 + 4, abs=0.3)


def test_nothing_in_the_way() -> None:
    path = plan(EMPTY)
    assert (path["length"], path["margin"], path["lost"]) == (3, None, None)


def test_no_ways_unless_asked_for() -> None:
    assert snapshot(text=room(), draw=False).plans == []


@pytest.fixture
def space(make: Make) -> FreeSpace:
    return FreeSpace(make(room()).simulation, 0, (0.0, 0.0, 10.0, 6.0), 0.3)


def test_distances_are_those_of_geometry(space: FreeSpace) -> None:
    points = np.array([[1.0, 3.0], [4.0, 2.0], [5.0, 5.0], [9.5, 3.0]])
    exact = [1.0, 0.8, 1.0, 0.5]
    assert space.distance_at(points) == pytest.approx(exact, abs=2 * space.half_diagonal)
    assert [space.exact_distance((float(x), float(y))) for x, y in points] == pytest.approx(exact, abs=1e-3)


def test_a_way_over_cells_leads_from_start_to_goal(space: FreeSpace) -> None:
    start, goal = np.array([1.01, 3.02]), np.array([9.03, 2.99])
    way = space.path(start, goal, 0.3, 0.1)
    assert (way[0], way[-1]) == (pytest.approx(start), pytest.approx(goal))
    assert space.distance_at(way).min() > 0.25
    by_the_wall = space.path(start, np.array([9.8, 3.0]), 0.3, 0.2)
    assert 9.5 < by_the_wall[-1, 0] < 9.75
    assert space.path(start, np.array([5.0, 2.0]), 0.3, 0.1) is None


def test_shade_and_lines(make: Make) -> None:
    scene = scene_of(make(room()))
    fields = [mark.geometry for mark in scene.marks if mark.part == "field"]
    assert any(isinstance(shape, Region) for shape in fields)
    line = next(shape for shape in fields if isinstance(shape, Line))
    assert 0 < line.points[:, 0].min() < line.points[:, 0].max() < 10
    assert [label.text for label in scene.labels if label.part == "field"][:2] == ["0.3 m", "0.5 m"]


def test_nothing_stands_nothing_is_drawn(make: Make) -> None:
    assert not any(mark.part == "field" for mark in scene_of(make(EMPTY)).marks)


@pytest.mark.parametrize("template", ["maze", "perlin-forest", "car-park", "crowd", "mixed-fleet", "shape-gallery"])
def test_templates(template: str) -> None:
    overlays = snapshot(str(scenario_file(template)), seed=1, overlays=["names", "clearance", "plan"], size=400)
    assert overlays.png != snapshot(str(scenario_file(template)), seed=1, overlays=["names"], size=400).png
    assert all(path.lost is None for path in overlays.plans)


LANE = """\
world: {{width: 20, height: 6}}
robot:
  - {{name: car, kinematics: {{name: acker}}, shape: {{name: rectangle, length: 4.4, width: 1.8, wheelbase: 2.6}},
     state: [3, 3, 0, 0], goal: [15, 3, 0], behavior: {{name: dash}}}}
obstacle:
  - {{name: south, state: [10, 0.5], shape: {{name: rectangle, length: 30, width: 1}}}}
  - {{name: north, state: [10, {north}], shape: {{name: rectangle, length: 30, width: 1}}}}
"""


def test_the_margin_of_a_car_beside_a_wall_is_that_of_its_side() -> None:
    path = plan(LANE.format(north=5.2))
    assert (path["margin"], path["nearest"]) == (pytest.approx(4.7 - 3 - 0.9, abs=1e-3), "north")


def test_the_margin_of_a_car_counts_its_bumper_at_the_goal() -> None:
    wall = "  - {name: end, state: [19.5, 3], shape: {name: rectangle, length: 1, width: 2}}\n"
    path = plan(LANE.format(north=5.9) + wall)
    front = (4.4 - 2.6) / 2 + 2.6  # from the rear axle, about which the car is placed
    margin = 19 - 15 + 0.1 - front  # it stops within the goal_threshold
    assert (path["margin"], path["nearest"]) == (pytest.approx(margin, abs=0.08), "end")


def test_the_outline_of_a_car_is_drawn_where_it_has_the_least_margin(make: Make) -> None:
    (path,) = plan_paths(make(LANE.format(north=5.2)).simulation)
    body, enlarged = path.outlines
    assert np.ptp(body, axis=0) == pytest.approx([4.4, 1.8])
    assert enlarged[:, 1].max() == pytest.approx(4.7, abs=1e-3)  # it touches the wall


def test_the_least_margin_counts_people_who_stand() -> None:
    ben = "  - {name: ben, state: [5, 5.4], shape: {name: circle, radius: 0.2}, tags: [pedestrian]}\n"
    text = room(middle=1.0).replace("state: [1, 3], goal: [9, 3]", "state: [1, 4.5], goal: [9, 4.5]") + ben
    path = plan(text)
    assert (path["margin"], path["nearest"]) == (pytest.approx(0.9 - 0.3 - 0.2, abs=1e-3), "ben")
    assert path["tightest"] == pytest.approx((5, 4.5), abs=0.1)


def test_the_room_of_a_car_is_that_of_its_footprint_along_its_path(make: Make) -> None:
    env = make(scenario_file("car-park").read_text())
    footprint = footprint_of(env, requested_plans(env, ["plan"]))
    shape, poses = footprint

    def shaded(given: Any) -> BaseGeometry:
        scene = SceneBuilder(env.simulation).build()
        draw_clearance(scene, env.simulation, path=given)
        regions = [m.geometry for m in scene.marks if isinstance(m.geometry, Region) and m.part == "field"]
        labels = [label.text for label in scene.labels if label.part == "field"]
        assert ("touches" in labels) == (given is not None)
        return union_all([Polygon(region.rings[0], region.rings[1:]) for region in regions])

    disc, car = shaded(None), shaded(footprint)
    for point in ((13.5, 11.2), (8.0, 11.9), (17.0, 9.8), (13.0, 9.0)):
        nearest = poses[np.hypot(*(poses[:, :2] - point).T).argmin(), 2]
        body = translate(rotate(Polygon(shape.corners), nearest, (0, 0), use_radians=True), *point)
        hit = any(body.intersects(other.geometry) for other in env.obstacle_list)
        assert car.contains(Point(point)) == hit, point
    assert car.contains(Point(13.5, 11.2)), "the disc fits there and the car does not"
    assert not disc.contains(Point(13.5, 11.2))
    on_the_way = poses[[0, len(poses) // 3, len(poses) // 2]]
    assert not any(car.contains(Point(x, y)) for x, y, _ in on_the_way)


def test_a_round_robot_needs_no_footprint(make: Make) -> None:
    env = make(scenario_file("maze").read_text())
    assert footprint_of(env, requested_plans(env, ["plan"])) is None
