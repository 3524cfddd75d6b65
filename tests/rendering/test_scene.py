"""The content of the scene of a simulation."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import shapely

from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Circle, Line, Region, Sector
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.view import ObjectView
from irsim.simulation.simulation import Simulation
from tests.env.driving import Make, take_steps

ROBOT = """
robot: {kinematics: {name: %s}, shape: {name: circle, radius: 0.3}, state: [2, 3, 0], goal: [8, 3, 0],
        behavior: {name: dash}, %s}
"""


def scene(env: Any, **kwargs: Any) -> Any:
    return SceneBuilder(env.simulation).build(**kwargs)


def parts(env: Any, object_id: int = 0, **kwargs: Any) -> set[str]:
    return {mark.part for mark in scene(env, **kwargs).marks if mark.object == object_id}


def test_a_body_stands_where_its_object_is(make: Make) -> None:
    env = make(ROBOT % ("diff", "plot: {show_goal: true}"))
    take_steps(env, 5)
    shown = scene(env)
    (body,), (goal,) = shown.of(0, "body"), shown.of(0, "goal")
    assert isinstance(body.geometry, Circle)
    assert (body.geometry.x, body.geometry.y) == pytest.approx(tuple(env.robot.position[:, 0]))
    assert (goal.geometry.x, goal.geometry.y, goal.geometry.radius) == pytest.approx((8, 3, 0.3))
    assert (shown.time, shown.extent) == (pytest.approx(0.5), (0, 10, 0, 10))


@pytest.mark.parametrize(("drive", "arrow"), [("diff", True), ("acker", True), ("omni_angular", True), ("omni", False)])
def test_heading_arrows_are_for_drives_with_a_heading(make: Make, drive: str, arrow: bool) -> None:
    assert ("arrow" in parts(make(ROBOT % (drive, "")))) is arrow
    assert "arrow" not in parts(make(ROBOT % (drive, "plot: {show_arrow: false}")))
    assert "arrow" in parts(make(ROBOT % (drive, "plot: {show_arrow: true}")))


def test_a_car_is_a_picture_unless_its_description_is_empty(make: Make) -> None:
    car = ROBOT.replace("radius: 0.3", "radius: 0.3, wheelbase: 0.3") % ("acker", "color: darkgreen%s")
    plain, pictured = (make(car % more).simulation for more in (", description: ''", ""))
    shown = [SceneBuilder(each, has_picture=lambda name: True).build() for each in (plain, pictured)]
    assert [[one.name for one in each.pictures] for each in shown] == [[], ["car_green.png"]]
    assert [len(list(each.of(0, "body"))) for each in shown] == [1, 0]


@pytest.mark.parametrize(("name", "label"), [("Tischläufer", "Tischläufer"), ("小车", "r0"), ("cart 小车", "r0")])
def test_names_in_letters_that_pictures_lack_are_numbers_there(make: Make, name: str, label: str) -> None:
    env = make(ROBOT % ("diff", f"name: {name}"))
    assert env.robot.drawing.label == label


def test_the_arrow_of_an_omni_drive_points_where_it_goes(make: Make) -> None:
    env = make(ROBOT.replace("goal: [8, 3, 0]", "goal: [2, 8]") % ("omni", "plot: {show_arrow: true}"))
    env.step()
    (arrow,) = scene(env).of(0, "arrow")
    left, _, right, top = bounds(arrow.geometry)
    assert (top - env.robot.position[1, 0], (left + right) / 2) == pytest.approx((0.4, 2.0))


def test_overrides_of_a_frame_show_and_hide(make: Make) -> None:
    env = make(ROBOT % ("diff", "plot: {show_goal: true}"))
    assert "goal" not in parts(env, overrides={"show_goal": False})
    assert "trajectory" not in parts(env)
    take_steps(env, 2)
    assert "trajectory" in parts(env, overrides={"show_trajectory": True})


@pytest.mark.parametrize(("mode", "colors"), [("dynamic", "rk"), ("static", ["#009E73", "r"]), ("all", "rr")])
def test_overrides_reach_the_objects_of_the_mode_only(make: Make, mode: str, colors: Any) -> None:
    env = make(ROBOT % ("diff", "") + "\nobstacle: {state: [5, 5, 0], shape: {name: circle}}")
    marks = scene(env, mode=mode, overrides={"obj_color": "r"}).marks
    assert [mark.fill for mark in marks if mark.part == "body"] == [*colors]


def test_trajectories_and_trails_follow_the_path(make: Make) -> None:
    env = make(ROBOT % ("diff", "plot: {show_trajectory: true, show_trail: true, trail_freq: 3}"))
    take_steps(env, 10)
    shown = scene(env)
    (path,) = shown.of(0, "trajectory")
    assert np.allclose(path.geometry.points, np.array([s[:2, 0] for s in env.robot.trajectory]))
    stroke = path.stroke
    assert (stroke.color, stroke.metric, stroke.width) == (env.robot.color, True, pytest.approx(0.6))
    snapshots = [mark.geometry.x for mark in shown.of(0, "trail")]
    assert snapshots == pytest.approx([2, *(env.robot.trajectory[k][0, 0] for k in (2, 5, 8))])
    (last,) = scene(env, overrides={"keep_traj_length": 4}).of(0, "trajectory")
    assert len(last.geometry.points) == 4
    kept = list(scene(env, overrides={"keep_trail_length": 2}).of(0, "trail"))
    assert [mark.geometry.x for mark in kept] == snapshots[2:]


def test_a_trail_grows_like_one_made_at_once(make: Make) -> None:
    env = make(ROBOT % ("diff", "plot: {show_trail: true}"))
    builder = SceneBuilder(env.simulation)
    for _ in range(9):
        env.step()
        grown = [mark.geometry.x for mark in builder.build().of(0, "trail")]
    assert grown == [mark.geometry.x for mark in scene(env).of(0, "trail")]
    assert len(grown) == 5
    env.reset()
    assert [mark.geometry.x for mark in builder.build().of(0, "trail")] == [2]


@pytest.mark.parametrize("kind", ["ellipse", "rectangle", "circle"])
def test_trails_may_have_another_shape(make: Make, kind: str) -> None:
    env = make(ROBOT % ("diff", f"plot: {{show_trail: true, trail_type: {kind}}}"))
    take_steps(env, 2)
    _, snapshot = scene(env).of(0, "trail")
    left, bottom, right, top = bounds(snapshot.geometry)
    assert (right - left, top - bottom) == pytest.approx((0.6, 0.6), abs=1e-2)


def test_beams_end_where_the_scan_says(make: Make) -> None:
    lidar = "{name: lidar2d, number: 5, range_max: 4, angle_range: 3.14159265, offset: [0.1, 0, 0]}"
    wall = "\nobstacle: {state: [5, 3, 0], shape: {name: rectangle, length: 1, width: 4}}"
    env = make(ROBOT % ("diff", f"sensors: [{lidar}]") + wall)
    (beams,) = scene(env).beams
    assert (beams.origin, beams.ends[2]) == (pytest.approx((2.1, 3.0)), pytest.approx((4.5, 3.0)))
    assert beams.ends[0] == pytest.approx((2.1, -1.0))
    assert (beams.color, beams.alpha) == ("#CC3311", 0.3)
    assert scene(env, overrides={"show_sensor": False}).beams == []


def test_a_view_sector_opens_along_the_heading(make: Make) -> None:
    text = "robot: {kinematics: {name: diff}, state: [5, 5, 1], fov: %s, fov_radius: 3, plot: {show_fov: true}}"
    part, whole = (next(scene(make(text % fov)).of(0, "fov")).geometry for fov in (1.2, 6.2831853))
    assert isinstance(part, Sector)
    assert (part.x, part.y, part.radius, part.start, part.end) == pytest.approx((5, 5, 3, 0.4, 1.6))
    assert isinstance(whole, Circle)


WATCHED = """
world: {width: 10, height: 10%s}
robot: {kinematics: {name: diff}, state: [5, 1, 1.5707963], fov: 1.2, fov_radius: 6, fov_occlusion: %s,
        plot: {show_fov: true}}
obstacle:
  - {name: box, shape: {name: rectangle, length: 1, width: 1}, state: [5, 4, 0]}
  - {name: ghost, shape: {name: rectangle, length: 1, width: 1}, state: [4, 3, 0], unobstructed: true}
"""


def seen_area(env: Any) -> Any:
    """The area that the picture shows as seen by the robot."""
    (mark,) = scene(env).of(0, "fov")
    return shapely.Polygon(mark.geometry.rings[0])


def test_a_view_with_occlusion_is_drawn_as_far_as_it_sees(make: Make) -> None:
    area = seen_area(make(WATCHED % ("", "true")))
    for seen, (x, y) in ((True, (5, 3.4)), (False, (5, 5)), (False, (5, 6.9)), (True, (3.6, 5)), (True, (4, 3))):
        assert area.contains(shapely.Point(x, y)) == seen, (x, y)
    (whole,) = scene(make(WATCHED % ("", "false"))).of(0, "fov")
    assert isinstance(whole.geometry, Sector)  # without occlusion it sees through bodies


def test_a_view_ends_at_a_map_and_follows_what_moves(make: Make) -> None:
    env = make(WATCHED % (", obstacle_map: {name: perlin, resolution: 0.25, fill: 0.3, seed: 3}", "true"))
    area, grid = seen_area(env), env.simulation.scenario.grid
    assert 0 < area.area < 0.5 * 1.2 * 36 - 2
    solid = [(x, y) for x in range(40) for y in range(40) if grid.cells.occupied[x, y]]
    inside = [cell for cell in solid if area.contains(shapely.Point((cell[0] + 0.5) / 4, (cell[1] + 0.5) / 4))]
    assert len(inside) <= 1  # rays are half a degree apart
    moving = make(WATCHED % ("", "true"))
    before = seen_area(moving)
    moving.obstacle_list[0].set_state([3, 4, 0])
    after = seen_area(moving)
    assert not before.contains(shapely.Point(5, 6))
    assert after.contains(shapely.Point(5, 6))


def test_a_goal_without_heading_is_drawn_without_one(make: Make) -> None:
    text = (
        "robot: {kinematics: {name: diff}, shape: {name: rectangle, length: 2, width: 1}, state: [2, 2, 0], goal: %s,"
    )
    free, turned = (
        next(scene(make(f"{text} plot: {{show_goal: true}}}}" % goal)).of(0, "goal")).geometry
        for goal in ("[8, 8]", "[8, 8, 1.5707963]")
    )
    assert (free.x, free.y, free.radius) == (8, 8, 0.5)
    low, high = turned.rings[0].min(axis=0), turned.rings[0].max(axis=0)
    assert high - low == pytest.approx([1, 2])


def test_shapes_keep_their_kind(make: Make) -> None:
    env = make("""
obstacle:
  - {state: [5, 5, 1.5707963], shape: {name: rectangle, length: 2, width: 1}}
  - {state: [1, 1, 0], shape: {name: linestring, vertices: [[0, 0], [1, 0], [1, 2]]}}
  - state: [3, 3, 0.5]
    shape:
      name: compound
      parts: [{name: rectangle, length: 2, width: 0.4}, {name: circle, radius: 0.6, pose: [0.8, 0, 0]}]
""")
    box, line, compound = scene(env).marks
    assert [type(mark.geometry) for mark in (box, line, compound)] == [Region, Line, Region]
    assert bounds(box.geometry) == pytest.approx((4.5, 4, 5.5, 6))
    assert line.fill is None
    drawn, body = shapely.Polygon(compound.geometry.rings[0]), env.objects[2].geometry
    assert drawn.area == pytest.approx(body.area, rel=5e-3)
    assert drawn.centroid.distance(body.centroid) < 0.02


def test_labels_name_objects_and_goals(make: Make) -> None:
    env = make(ROBOT % ("diff", "plot: {show_text: true, show_goal: true, show_goal_text: true}"))
    name, goal = scene(env).labels
    assert (name.text, name.x, name.y) == ("r0", pytest.approx(2 - 0.4), pytest.approx(3 + 0.4))
    assert (goal.text, goal.x, goal.y) == ("G-r0", pytest.approx(8 - 0.4), pytest.approx(3 + 0.4))
    env.robot.set_text("Anna")
    env.robot.set_goal_text("home")
    assert [label.text for label in scene(env).labels] == ["Anna", "home"]


@pytest.mark.parametrize(("viewpoint", "center"), [("anna", (2, 3)), ([1, 7], (1, 7)), ("missing", None), (None, None)])
def test_the_view_follows_an_object_or_a_point(make: Make, viewpoint: Any, center: Any) -> None:
    assert scene(make(ROBOT % ("diff", "name: anna")), viewpoint=viewpoint).center == center


def test_scenes_are_json(make: Make) -> None:
    keys = "plot: {show_text: true, show_goal: true, show_trajectory: true}, sensors: [{name: lidar2d, number: 3}]"
    env = make(ROBOT % ("diff", f"description: diff_robot0.png, {keys}"))
    take_steps(env, 2)
    builder = SceneBuilder(env.simulation, has_picture=lambda name: True)
    data = json.loads(json.dumps(builder.build(status="Running").as_dict(), allow_nan=False))
    assert (data["marks"][0]["geometry"]["kind"], data["pictures"][0]["name"]) == ("circle", "diff_robot0.png")
    assert (len(data["beams"][0]["ends"]), data["status"]) == (3, "Running")


def test_what_did_not_change_is_the_same_mark(make: Make) -> None:
    env = make(ROBOT % ("diff", "") + "\nobstacle: {state: [5, 8, 0], shape: {name: circle}}")
    builder = SceneBuilder(env.simulation)
    first = builder.build()
    env.step()
    second = builder.build()
    assert [next(first.of(k, "body")) is next(second.of(k, "body")) for k in (0, 1)] == [False, True]


def test_shapes_of_the_next_scene_are_seen(make: Make) -> None:
    env = make("obstacle: {state: [5, 5, 0], shape: {name: circle, random_shape: true, radius_range: [0.2, 2.0]}}")
    builder = SceneBuilder(env.simulation)
    before = next(builder.build().of(0, "body")).geometry.radius
    env.reset(random=True)
    after = next(builder.build().of(0, "body")).geometry.radius
    assert before != after == pytest.approx(env.objects[0].radius)


def test_a_world_of_a_batch_can_be_looked_at(make: Make) -> None:
    env = make(ROBOT.replace("state: [2, 3, 0]", "number: 2, distribution: {name: random}") % ("diff", ""))
    simulation = Simulation(env.scenario, [1, 2], history=True)
    simulation.make_view = ObjectView
    simulation.step()
    for world in (0, 1):
        shown = SceneBuilder(simulation, world=world).build()
        places = [(m.geometry.x, m.geometry.y) for m in shown.marks if m.part == "body"]
        assert np.allclose(places, simulation.pose[2 * world : 2 * world + 2, :2])
    assert shown.time == pytest.approx(0.1)
