"""The content of the scene of a simulation."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import shapely

from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Circle, Line, Region, Sector
from irsim.objects.drawing.scene_builder import SceneBuilder

ROBOT = """
robot: {kinematics: {name: %s}, shape: {name: circle, radius: 0.3}, state: [2, 3, 0], goal: [8, 3, 0],
        behavior: {name: dash}, %s}
"""


def scene(env: Any, **kwargs: Any) -> Any:
    return SceneBuilder(env.simulation).build(**kwargs)


def parts(env: Any, object_id: int = 0, **kwargs: Any) -> set[str]:
    return {mark.part for mark in scene(env, **kwargs).marks if mark.object == object_id}


def test_a_body_stands_where_its_object_is(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "plot: {show_goal: true}"))
    for _ in range(5):
        env.step()
    shown = scene(env)
    (body,), (goal,) = shown.of(0, "body"), shown.of(0, "goal")
    assert isinstance(body.geometry, Circle)
    assert (body.geometry.x, body.geometry.y) == pytest.approx(tuple(env.robot.position[:, 0]))
    assert (goal.geometry.x, goal.geometry.y, goal.geometry.radius) == pytest.approx((8, 3, 0.3))
    assert shown.time == pytest.approx(0.5)
    assert shown.extent == (0, 10, 0, 10)


@pytest.mark.parametrize(("drive", "arrow"), [("diff", True), ("acker", True), ("omni_angular", True), ("omni", False)])
def test_heading_arrows_are_for_drives_with_a_heading(make: Callable[..., Any], drive: str, arrow: bool) -> None:
    assert ("arrow" in parts(make(ROBOT % (drive, "")))) is arrow
    assert "arrow" not in parts(make(ROBOT % (drive, "plot: {show_arrow: false}")))
    assert "arrow" in parts(make(ROBOT % (drive, "plot: {show_arrow: true}")))


def test_the_arrow_of_an_omni_drive_points_where_it_goes(make: Callable[..., Any]) -> None:
    env = make(
        "robot: {kinematics: {name: omni}, state: [2, 2, 0], goal: [2, 8],"
        " behavior: {name: dash}, plot: {show_arrow: true}}"
    )
    env.step()
    (arrow,) = scene(env).of(0, "arrow")
    left, _, right, top = bounds(arrow.geometry)
    assert top - env.robot.position[1, 0] == pytest.approx(0.4)
    assert (left + right) / 2 == pytest.approx(2.0)


def test_overrides_of_a_frame_show_and_hide(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "plot: {show_goal: true}"))
    assert "goal" not in parts(env, overrides={"show_goal": False})
    assert "trajectory" not in parts(env)
    env.step(), env.step()
    assert "trajectory" in parts(env, overrides={"show_trajectory": True})


def test_overrides_reach_the_objects_of_the_mode_only(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "") + "\nobstacle: {state: [5, 5, 0], shape: {name: circle}}")
    colors = {"obj_color": "r"}
    assert [m.fill for m in scene(env, mode="dynamic", overrides=colors).marks if m.part == "body"] == ["r", "k"]
    assert [m.fill for m in scene(env, mode="static", overrides=colors).marks if m.part == "body"] == ["#009E73", "r"]
    assert [m.fill for m in scene(env, mode="all", overrides=colors).marks if m.part == "body"] == ["r", "r"]


def test_trajectories_and_trails_follow_the_path(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "plot: {show_trajectory: true, show_trail: true, trail_freq: 3}"))
    for _ in range(10):
        env.step()
    shown = scene(env)
    (path,) = shown.of(0, "trajectory")
    assert np.allclose(path.geometry.points, np.array([s[:2, 0] for s in env.robot.trajectory]))
    assert path.stroke.color == env.robot.color
    assert path.stroke.metric
    assert path.stroke.width == pytest.approx(0.6)
    snapshots = [mark.geometry.x for mark in shown.of(0, "trail")]
    assert snapshots == pytest.approx([2, *(env.robot.trajectory[k][0, 0] for k in (2, 5, 8))])
    (last,) = scene(env, overrides={"keep_traj_length": 4}).of(0, "trajectory")
    assert len(last.geometry.points) == 4
    kept = list(scene(env, overrides={"keep_trail_length": 2}).of(0, "trail"))
    assert [mark.geometry.x for mark in kept] == snapshots[2:]


def test_a_trail_grows_like_one_made_at_once(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "plot: {show_trail: true}"))
    builder = SceneBuilder(env.simulation)
    for _ in range(9):
        env.step()
        grown = [mark.geometry.x for mark in builder.build().of(0, "trail")]
    assert grown == [mark.geometry.x for mark in scene(env).of(0, "trail")]
    assert len(grown) == 5
    env.reset()
    assert [mark.geometry.x for mark in builder.build().of(0, "trail")] == [2]


@pytest.mark.parametrize(("kind", "size"), [("ellipse", (0.6, 0.6)), ("rectangle", (0.6, 0.6)), ("circle", (0.6, 0.6))])
def test_trails_may_have_another_shape(make: Callable[..., Any], kind: str, size: tuple[float, float]) -> None:
    env = make(ROBOT % ("diff", f"plot: {{show_trail: true, trail_type: {kind}}}"))
    env.step(), env.step()
    _, snapshot = scene(env).of(0, "trail")
    left, bottom, right, top = bounds(snapshot.geometry)
    assert (right - left, top - bottom) == pytest.approx(size, abs=1e-2)


def test_beams_end_where_the_scan_says(make: Callable[..., Any]) -> None:
    env = make(
        ROBOT
        % ("diff", "sensors: [{name: lidar2d, number: 5, range_max: 4, angle_range: 3.14159265, offset: [0.1, 0, 0]}]")
        + "\nobstacle: {state: [5, 3, 0], shape: {name: rectangle, length: 1, width: 4}}"
    )
    (beams,) = scene(env).beams
    assert beams.origin == pytest.approx((2.1, 3.0))
    assert beams.ends[2] == pytest.approx((4.5, 3.0))
    assert beams.ends[0] == pytest.approx((2.1, -1.0))
    assert (beams.color, beams.alpha) == ("#CC3311", 0.3)
    assert scene(env, overrides={"show_sensor": False}).beams == []


def test_a_view_sector_opens_along_the_heading(make: Callable[..., Any]) -> None:
    env = make("robot: {kinematics: {name: diff}, state: [5, 5, 1], fov: 1.2, fov_radius: 3, plot: {show_fov: true}}")
    (mark,) = scene(env).of(0, "fov")
    sector = mark.geometry
    assert isinstance(sector, Sector)
    assert (sector.x, sector.y, sector.radius, sector.start, sector.end) == pytest.approx((5, 5, 3, 0.4, 1.6))
    env = make("robot: {kinematics: {name: diff}, fov: 6.2831853, fov_radius: 3, plot: {show_fov: true}}")
    (mark,) = scene(env).of(0, "fov")
    assert isinstance(mark.geometry, Circle)


def test_shapes_keep_their_kind(make: Callable[..., Any]) -> None:
    env = make(
        """
obstacle:
  - {state: [5, 5, 1.5707963], shape: {name: rectangle, length: 2, width: 1}}
  - {state: [1, 1, 0], shape: {name: linestring, vertices: [[0, 0], [1, 0], [1, 2]]}}
  - state: [3, 3, 0.5]
    shape:
      name: compound
      parts: [{name: rectangle, length: 2, width: 0.4}, {name: circle, radius: 0.6, pose: [0.8, 0, 0]}]
"""
    )
    box, line, compound = scene(env).marks
    assert isinstance(box.geometry, Region)
    assert bounds(box.geometry) == pytest.approx((4.5, 4, 5.5, 6))
    assert isinstance(line.geometry, Line)
    assert line.fill is None
    assert isinstance(compound.geometry, Region)
    drawn = shapely.Polygon(compound.geometry.rings[0])
    assert drawn.area == pytest.approx(env.objects[2].geometry.area, rel=5e-3)
    assert drawn.centroid.distance(env.objects[2].geometry.centroid) < 0.02


def test_labels_name_objects_and_goals(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "plot: {show_text: true, show_goal: true, show_goal_text: true}"))
    name, goal = scene(env).labels
    assert (name.text, goal.text) == ("r0", "G-r0")
    assert (name.x, name.y) == pytest.approx((2 - 0.4, 3 + 0.4))
    assert (goal.x, goal.y) == pytest.approx((8 - 0.4, 3 + 0.4))
    env.robot.set_text("Anna")
    env.robot.set_goal_text("home")
    assert [label.text for label in scene(env).labels] == ["Anna", "home"]


def test_the_view_follows_an_object_or_a_point(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "name: anna"))
    assert scene(env, viewpoint="anna").center == (2, 3)
    assert scene(env, viewpoint=[1, 7]).center == (1, 7)
    assert scene(env, viewpoint="missing").center is None
    assert scene(env).center is None


def test_scenes_are_json(make: Callable[..., Any]) -> None:
    keys = "plot: {show_text: true, show_goal: true, show_trajectory: true}, sensors: [{name: lidar2d, number: 3}]"
    env = make(ROBOT % ("diff", f"description: diff_robot0.png, {keys}"))
    env.step(), env.step()
    builder = SceneBuilder(env.simulation, has_picture=lambda name: True)
    data = json.loads(json.dumps(builder.build(status="Running").as_dict(), allow_nan=False))
    assert data["marks"][0]["geometry"]["kind"] == "circle"
    assert data["pictures"][0]["name"] == "diff_robot0.png"
    assert len(data["beams"][0]["ends"]) == 3
    assert data["status"] == "Running"


def test_what_did_not_change_is_the_same_mark(make: Callable[..., Any]) -> None:
    env = make(ROBOT % ("diff", "") + "\nobstacle: {state: [5, 8, 0], shape: {name: circle}}")
    builder = SceneBuilder(env.simulation)
    first = builder.build()
    env.step()
    second = builder.build()
    assert next(first.of(1, "body")) is next(second.of(1, "body"))
    assert next(first.of(0, "body")) is not next(second.of(0, "body"))


def test_shapes_of_the_next_scene_are_seen(make: Callable[..., Any]) -> None:
    env = make("obstacle: {state: [5, 5, 0], shape: {name: circle, random_shape: true, radius_range: [0.2, 2.0]}}")
    builder = SceneBuilder(env.simulation)
    before = next(builder.build().of(0, "body")).geometry.radius
    env.reset(random=True)
    after = next(builder.build().of(0, "body")).geometry.radius
    assert before != after
    assert after == pytest.approx(env.objects[0].radius)


def test_a_world_of_a_batch_can_be_looked_at(make: Callable[..., Any]) -> None:
    from irsim.objects.view import ObjectView
    from irsim.simulation.simulation import Simulation

    env = make(
        "robot: {kinematics: {name: diff}, behavior: {name: dash}, distribution: {name: random},"
        " number: 2, shape: {name: circle}}"
    )
    simulation = Simulation(env.scenario, [1, 2], history=True)
    simulation.make_view = ObjectView
    simulation.step()
    for world in (0, 1):
        shown = SceneBuilder(simulation, world=world).build()
        places = [(m.geometry.x, m.geometry.y) for m in shown.marks if m.part == "body"]
        assert np.allclose(places, simulation.pose[2 * world : 2 * world + 2, :2])
    assert math.isclose(shown.time, 0.1)
