"""Names of ``irsim.lib``: functions for arrays and objects, with numbers that IR-SIM 2.12.0 gives."""

from __future__ import annotations

import math
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely

import irsim
from irsim.lib import (
    Behavior,
    GeometryFactory,
    GroupBehavior,
    SocialForceModelBatch,
    ackermann_kinematics,
    differential_kinematics,
    generate_polygon,
    omni_kinematics,
    random_generate_polygon,
    reciprocal_vel_obs,
    register_behavior,
    social_force_model,
)
from irsim.lib.algorithm import cast_rays, omni_angular_kinematics
from irsim.lib.behavior import behavior_methods as methods
from tests.env.driving import Make, take_steps

SCENARIO = """
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 1, 0.3], goal: [9, 4],
     behavior: {name: dash}, velocity: [0.5, 0.1], acce: [1, 1]}
  - {kinematics: {name: omni}, shape: {name: rectangle, length: 0.6, width: 0.4}, state: [3, 2, 1.0], goal: [1, 1.5],
     behavior: {name: sfm}, velocity: [0.3, 0.2]}
  - {kinematics: {name: acker}, shape: {name: rectangle, length: 0.6, width: 0.4, wheelbase: 0.4},
     state: [2, 6, 0.3, 0.1], goal: [9, 4], behavior: {name: dash}}
  - {kinematics: {name: omni_angular}, shape: {name: circle, radius: 0.2}, state: [5, 6, 0.3], goal: [9, 4, 1.0],
     behavior: {name: dash}}
obstacle:
  - {shape: {name: linestring, vertices: [[2, 0], [2, 0.8], [2.5, 0.9]]}, state: [0, 0, 0]}
  - {shape: {name: circle, radius: 0.3}, state: [2.2, 1.8, 0]}
"""
EGO = [1, 1, 0.4, 0.1, 0.3, 1.0, 0.2, 0.3]
OTHERS = [[2, 1.2, -0.3, 0, 0.3], [1.5, 2, 0, -0.4, 0.4]]
LINES = [[0, 0, 3, 0]]


@pytest.fixture
def env(make: Make) -> Any:
    return make(SCENARIO)


def test_dash_of_arrays() -> None:
    state, goal = np.array([[1.0], [1.0], [0.3]]), np.array([[4.0], [3.0], [0.5]])
    two, three = np.array([[1.0], [2.0]]), np.array([[1.0], [2.0], [0.5]])
    expected = {
        "diff": (methods.DiffDash(state, goal, two), [0.958813123592, 2.0]),
        "ramp": (methods.DiffDash(state, goal, two, angular_acce=1.0, dt=0.1), [0.958813123592, 0.331283209846]),
        "omni": (methods.OmniDash(state, goal, two), [0.958813123592, 0.568075326087]),
        "acker": (methods.AckerDash(state, goal, two, 0.1, 0.1), [1.0, 0.288002603548]),
        "turning": (methods.OmniAngularDash(state, goal, three), [0.958813123592, 0.568075326087, 0.5]),
        "there": (methods.OmniAngularDash(goal - 0.01, goal, three), [0.0, 0.0, 0.0]),
    }
    for name, (control, numbers) in expected.items():
        assert control.shape == (len(numbers), 1), name
        assert control[:, 0] == pytest.approx(numbers, abs=1e-11), name


@pytest.mark.parametrize(
    ("function", "index", "expected"),
    [
        (methods.beh_diff_dash, 0, [0.6, 0.0]),
        (methods.beh_omni_dash, 1, [-0.7282569211, 0.685304207539]),
        (methods.beh_acker_dash, 2, [1.0, -0.578299659005]),
        (methods.beh_omni_angular_dash, 3, [0.722318278264, -0.691560774542, -1.0]),
        # The corner of the line pushes once and blocks no robot beside a free way, and the turn ends there with
        # 1 rad/s^2 (not as in 2.12).
        (methods.beh_diff_sfm, 0, [0.512689629309, 0.795829537608]),
        (methods.beh_omni_sfm, 1, [0.468723987233, 0.58436247764]),
    ],
)
def test_behaviors_of_objects(make: Make, function: Any, index: int, expected: list[float]) -> None:
    ego = make(SCENARIO).objects[index]
    control = function(ego, ego.external_objects, name="any", wander=False)
    assert (control[:, 0], len(control)) == (pytest.approx(expected, abs=1e-9), ego.vel_dim)


def test_behaviors_see_only_what_they_are_shown(make: Make) -> None:
    ego = make(SCENARIO).objects[1]
    alone = methods.beh_omni_sfm(ego, [])
    assert alone[:, 0] != pytest.approx(methods.beh_omni_sfm(ego, ego.external_objects)[:, 0], abs=1e-3)
    assert alone[:, 0] == pytest.approx(methods.beh_omni_sfm(ego, [], neighbor_threshold=0.01)[:, 0])


def test_a_behavior_of_users_on_top_of_a_built_in_one(make: Make) -> None:
    register_behavior("omni", "careful")(
        lambda ego_object, external_objects, **keys: 0.5 * methods.beh_omni_sfm(ego_object, external_objects, **keys)
    )
    text = SCENARIO.replace("{name: sfm}", "{name: careful}")
    env, plain = make(text), make(SCENARIO)
    env.step()
    plain.step()
    assert env.objects[1].velocity == pytest.approx(0.5 * plain.objects[1].velocity, abs=1e-12)


def test_in_a_batch_an_object_is_asked_in_its_own_world(tmp_path: Any) -> None:
    register_behavior("diff", "through")(
        lambda ego_object, external_objects, **_: methods.beh_diff_dash(ego_object, external_objects)
    )
    path = tmp_path / "scenario.yaml"
    text = "robot: {{number: 2, kinematics: {{name: diff}}, distribution: {{name: random}}, behavior: {{name: {0}}}}}"
    poses = []
    for name in ("through", "dash"):
        path.write_text(text.format(name))
        batch = irsim.batch(path, 3, seeds=[1, 2, 3])
        take_steps(batch, 5)
        poses.append(batch.pose.copy())
    assert poses[0] == pytest.approx(poses[1], abs=1e-12)


def test_social_forces_of_arrays() -> None:
    model = social_force_model(EGO, OTHERS, LINES)
    assert model.cal_vel() == pytest.approx([0.4840826400668017, 0.39801746222251233], abs=1e-12)
    assert model.desired_force() == pytest.approx([1.2, 0.2], abs=1e-12)
    assert model.social_force() == pytest.approx([-0.17103504730094443, -0.6611645593142674], abs=1e-9)
    assert model.obstacle_force() == pytest.approx([0.0, 0.41686201967850844], abs=1e-9)
    model.update(EGO, [], [])
    assert model.social_force() == [0.0, 0.0]
    fast = [0.0, 0.0, 5.0, 0.0, 0.3, 9.0, 0.0]
    assert math.hypot(*social_force_model(fast, vmax=1.2).cal_vel()) == pytest.approx(1.2)


def test_social_forces_of_several_at_once() -> None:
    other = [1.3, 1.5, 0.1, 0.1, 0.3, 0.5, 0.5, 0]
    batch = SocialForceModelBatch([EGO, other], OTHERS, LINES, social_groups=[[0, 1]])
    assert batch.n == 2
    expected = {
        "cal_vel": [[0.462698210684, 0.294607180381], [0.003938736937, 0.461241927399]],
        "desired_force": [[1.2, 0.2], [0.8, 0.8]],
        "social_force": [[-0.186759611767, -1.010084386777], [-0.735090495225, 0.322615138506]],
        "obstacle_force": [[0.0, 0.416862019679], [0.0, 0.223130160148]],
        "coherence_force": [[0.059588645776, 0.099314409627], [-0.059588645776, -0.099314409627]],
        "group_repulsive_force": [[-0.3, -0.5], [0.3, 0.5]],
        "gaze_force": [[0.0, 0.0], [-0.132581766367, -0.132581766367]],
    }
    for name, numbers in expected.items():
        assert getattr(batch, name)() == pytest.approx(np.array(numbers), abs=1e-9), name


def test_velocity_of_social_forces(env: Any) -> None:
    state = [1, 1, 0.477668244562803, 0.14776010333066977, 0.3, 0.9363291775690445, 0.351123441588, 0.3]
    assert methods.SFMVelocity(state) == pytest.approx((0.6630333489209558, 0.2235451151410533), abs=1e-9)


def test_behavior_objects(env: Any) -> None:
    robot = env.robot
    assert Behavior(robot.info, {"name": "dash"}).gen_vel(robot, robot.external_objects)[:, 0].tolist() == [0.6, 0.0]
    assert robot.obj_behavior.gen_vel(robot, [])[:, 0].tolist() == [0.6, 0.0]
    assert Behavior(robot.info, {}).gen_vel(robot, []).tolist() == [[0.0], [0.0]]
    with pytest.raises(ValueError, match="nope"):
        Behavior(robot.info, {"name": "nope"}).gen_vel(robot, [])


def test_group_behavior_objects(make: Make, capsys: pytest.CaptureFixture[str]) -> None:
    walker = make(SCENARIO).objects[1]
    group = GroupBehavior([walker], name="sfm")
    (control,) = group.gen_group_vel()
    assert control[:, 0] == pytest.approx([0.468723987233, 0.58436247764], abs=1e-9)
    (control,) = GroupBehavior([walker], name="orca").gen_group_vel()
    assert np.isfinite(control).all()
    assert GroupBehavior([walker]).gen_group_vel() == [None]
    assert GroupBehavior([walker, walker], name="nope").gen_group_vel() == [None, None]
    assert "nope" in capsys.readouterr().err


def test_registries_list_what_is_built_in() -> None:
    registry = import_module("irsim.lib.behavior.behavior_registry")
    import_module("irsim.lib.behavior.group_behavior_methods")
    assert registry.behaviors_map["diff", "dash"] is methods.beh_diff_dash
    assert ("omni", "orca") in registry.group_behaviors_class_map


@pytest.mark.parametrize(
    ("name", "keys", "area", "radius", "size", "centroid"),
    [
        ("circle", {"radius": 0.5}, 0.784137, 0.5, (1.0, 1.0), (0, 0)),
        ("Circle", {"radius": 0.3, "center": [1, 2], "wheelbase": 0.4}, 0.282289, 0.3, (0.6, 0.6), (1.2, 2)),
        ("rectangle", {"length": 2.0, "width": 1.0, "wheelbase": 1.2}, 2.0, 1.118034, (2.0, 1.0), (0.6, 0)),
        ("polygon", {"vertices": [[0, 0], [2, 0], [1, 0.2], [0, 1]]}, 0.7, 1.118034, (2, 1), (0.523810, 0.304762)),
        ("polygon", {}, 4.0, 1.414214, (2, 2), (0, 0)),
        ("linestring", {"vertices": [[0, 0], [2, 0], [2, 1]]}, 0.0, 1.118034, (2, 1), (1.333333, 0.166667)),
        (
            "compound",
            {"parts": [{"name": "circle", "radius": 0.3}, {"name": "rectangle", "width": 0.2, "pose": [0.5, 0, 0]}]},
            0.423469,
            0.653846,
            (1.3, 0.6),
            (0.215713, 0),
        ),
    ],
)
def test_shapes(name: str, keys: Any, area: float, radius: float, size: Any, centroid: Any) -> None:
    made = GeometryFactory.create_geometry(name, **keys)
    assert (made.geometry.area, made.radius) == (pytest.approx(area, abs=1e-6), pytest.approx(radius, abs=1e-6))
    assert (made.length, made.width) == pytest.approx(size)
    assert made.original_centroid[:, 0] == pytest.approx(centroid, abs=1e-6)
    assert made.wheelbase == keys.get("wheelbase")
    moved = made.step(np.array([[1.0], [2.0], [0.5]]))
    assert moved is made.geometry
    turn = np.array([[math.cos(0.5), -math.sin(0.5)], [math.sin(0.5), math.cos(0.5)]])
    where = turn @ np.array(centroid) + [1, 2]
    assert (moved.centroid.x, moved.centroid.y) == pytest.approx(tuple(where), abs=1e-6)
    if name != "compound":
        assert made.vertices == pytest.approx(turn @ made.original_vertices + [[1], [2]])


def test_inequalities() -> None:
    square = GeometryFactory.create_geometry("polygon", vertices=[[0, 1], [2, 1], [2, 0], [0, 0]])
    for G, h, cone, convex in (square.get_init_Gh(), square.get_Gh(vertices=square.original_vertices)):
        assert G.tolist() == [[0, -2], [1, 0], [0, 2], [-1, 0]]
        assert h[:, 0].tolist() == [0, 2, 2, 0]
        assert (cone, convex) == ("Rpositive", True)
    disc = GeometryFactory.create_geometry("circle", radius=0.5)
    assert disc.get_init_Gh()[1][:, 0] == pytest.approx([0, 0, -0.5])
    assert disc.get_Gh(center=np.array([[1], [2]]), radius=0.3)[1][:, 0].tolist() == [1, 2, -0.3]
    dent = GeometryFactory.create_geometry("polygon", vertices=[[0, 0], [2, 0], [1, 0.2], [0, 1]])
    assert dent.get_init_Gh() == (None, None, None, False)
    line = GeometryFactory.create_geometry("linestring", vertices=[[0, 0], [2, 0]])
    assert line.get_init_Gh() == (None, None, None, None)
    with pytest.raises(ValueError, match="unknown shape"):
        GeometryFactory.create_geometry("blob")
    with pytest.raises(TypeError):
        GeometryFactory.create_geometry("circle", size=3)


def test_shapes_of_objects(env: Any) -> None:
    for view in env.objects:
        assert view.gf.geometry.symmetric_difference(view.geometry).area < 0.001
        assert view.gf.radius == pytest.approx(view.radius, abs=1e-9)
    assert env.objects[1].gf.get_init_Gh()[3] is True
    assert env.objects[4].gf.get_init_Gh() == (None, None, None, None)


def test_random_polygons() -> None:
    for _ in range(50):
        points = generate_polygon([3, 4], 1.0, 0.2, 0.3, 7)
        assert points.shape == (7, 2)
        assert shapely.Polygon(points).is_valid
        assert shapely.LinearRing(points).is_ccw
        assert np.linalg.norm(points - [3, 4], axis=1).max() <= 2.0
    two = random_generate_polygon(number=2, num_vertices_range=[3, 6])
    assert [3 <= len(polygon) < 6 for polygon in two] == [True, True]
    with pytest.raises(ValueError, match="irregularity"):
        generate_polygon([0, 0], 1.0, 2, 0.3, 5)


def test_beams_against_geometries() -> None:
    beams = shapely.MultiLineString([[(0, 0), (5, 0)], [(0, 0), (3, 3)], [(0, 0), (0, 5)]])
    box = SimpleNamespace(geometry=shapely.box(2, -1, 3, 1))
    line = SimpleNamespace(geometry=shapely.LineString([(-1, 2), (1, 2)]))
    ranges, hits, origin, directions = cast_rays(beams, [box, line], 5.0)
    assert ranges.tolist() == [2.0, 5.0, 2.0]
    assert hits.tolist() == [0, -1, 1]
    assert origin.tolist() == [0, 0]
    assert directions == pytest.approx(np.array([[1, 0], [0.6, 0.6], [0, 1]]))
    ranges, hits, _, _ = cast_rays(beams, [], 5.0)
    assert (ranges.tolist(), hits.tolist()) == ([5.0] * 3, [-1] * 3)
    along = SimpleNamespace(geometry=shapely.LineString([(4, 0), (3, 0)]))
    assert cast_rays(beams, [along], 5.0)[0][0] == pytest.approx(3.0)


@pytest.mark.parametrize(
    ("mode", "free", "with_line"),
    [("rvo", [0.8, -0.3], [0.45, -0.15]), ("hrvo", [0.8, -0.3], [0.45, -0.15]), ("vo", [0.55, -0.4], [0.55, -0.4])],
)
def test_velocity_obstacles_of_arrays(mode: str, free: list[float], with_line: list[float]) -> None:
    """With ``vo`` all velocities that lead on meet the line, which is 1.2 m away: too far to count, but not in 2.12."""
    model = reciprocal_vel_obs(EGO, OTHERS)
    assert model.cal_vel(mode) == pytest.approx(free, abs=1e-12)
    model.update(EGO, OTHERS, LINES)
    assert model.cal_vel(mode) == pytest.approx(with_line, abs=1e-12)
    assert reciprocal_vel_obs(EGO).cal_vel() == pytest.approx([0.85, 0.2], abs=1e-12), "no neighbor"
    with pytest.raises(ValueError, match="sideways"):
        model.cal_vel("sideways")


def test_velocity_obstacles_of_objects(env: Any, make: Make) -> None:
    robot, walker = env.objects[:2]
    # The turn of 0.1567 rad ends there with 1 rad/s^2; as in 2.12 it takes 0.2 s, whatever the limits.
    assert methods.beh_diff_rvo(robot, robot.external_objects)[:, 0] == pytest.approx(
        [0.6762912875, -0.5112147923], abs=1e-9
    )
    (at_once,) = make(SCENARIO.replace(", acce: [1, 1]", "")).objects[:1]
    as_before = methods.beh_diff_rvo(at_once, at_once.external_objects, turning="fixed")
    assert as_before[:, 0] == pytest.approx([0.676291287492, -0.783644376869], abs=1e-9)
    expected = [0.032500270611, -0.031179356294]
    assert methods.beh_omni_rvo(walker, walker.external_objects)[:, 0] == pytest.approx(expected, abs=1e-9)
    far = methods.beh_diff_rvo(robot, env.objects[3:4], vxmax=1.0, acce=0.5, mode="vo", name="rvo", wander=False)
    assert far[:, 0] == pytest.approx([0.989005461439, 0.0], abs=1e-9)


def test_velocity_obstacles_in_the_command_frame() -> None:
    ego = [1, 1, 0.477668244562803, 0.14776010333066977, 0.3, 0.9363291775690445, 0.35112344158839165, 0.3]
    assert methods.DiffRVO(ego, [])[:, 0] == pytest.approx([0.989005461439, 0.0], abs=1e-9)
    behind = [0, 0, 0, 0, 0.3, -1.0, 0.0, 0.0]
    assert methods.DiffRVO(behind, [])[:, 0] == pytest.approx([0.0, 1.5]), "it turns on the spot without a neighbor"
    world = methods.OmniRVO(ego, [])[:, 0]
    assert world == pytest.approx(methods.OmniRVO([*ego[:7], 2.0], [])[:, 0]), "world frame, whatever the heading"


# functions that move a column by one period
diff, acker, omni, turning = differential_kinematics, ackermann_kinematics, omni_kinematics, omni_angular_kinematics
STATE, CAR = np.array([[0.0], [0.0], [3.1]]), np.array([[0.0], [0.0], [3.1], [0.2]])
TWO, THREE = np.array([[1.0], [0.5]]), np.ones((3, 1))


@pytest.mark.parametrize(
    ("function", "arguments", "expected"),
    [
        (diff, (CAR, TWO, 0.1), [-0.09991351502732795, 0.004158066243329049, -3.133185307179586]),
        (acker, (CAR, TWO, 0.1), [-0.09991351502732795, 0.004158066243329049, 3.120271003550867, 0.5]),
        (omni, (STATE, TWO, 0.1), [-0.10199254814899249, -0.045798691270334924, 3.1]),
        (turning, (STATE, THREE, 0.1), [-0.104071581270657, -0.0957554487839989, -3.083185307179586]),
    ],
)
def test_kinematics_of_columns(function: Any, arguments: tuple[Any, ...], expected: list[float]) -> None:
    out = function(*arguments)
    assert (out.shape, out[:, 0]) == ((len(expected), 1), pytest.approx(expected, abs=1e-12))


@pytest.mark.parametrize(
    ("function", "arguments", "error"),
    [
        (diff, (STATE[:2], TWO, 0.1), ValueError),
        (diff, (STATE, TWO[:1], 0.1), ValueError),
        (diff, ([0, 0, 0], TWO, 0.1), TypeError),
        (diff, (STATE, TWO, 0.1, True, [0, 0]), ValueError),
        (diff, (STATE, TWO, 0.1, False, None, "rk4"), ValueError),
        (acker, (STATE, TWO, 0.1), ValueError),
        (acker, (CAR, TWO, 0.1, False, None, "sideways"), ValueError),
        (turning, (STATE, TWO, 0.1), ValueError),
    ],
)
def test_columns_of_a_wrong_shape_are_refused(function: Any, arguments: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        function(*arguments)


def test_noise_of_kinematics_has_the_stated_deviation() -> None:
    outs = np.array([diff(STATE * 0, TWO, 1.0, True, [0.04, 0.0, 0.0, 0.09])[:, 0] for _ in range(4000)])
    assert outs[:, [0, 2]].std(axis=0) == pytest.approx([0.2, 0.15], rel=0.1)
