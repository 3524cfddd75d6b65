"""Checks of motion and units: what cannot move, what jumps over walls, numbers in the wrong unit."""

from __future__ import annotations

import math
from typing import Any

import pytest

import irsim
import irsim._core as core
from irsim.components.shapes.polygon import Polygon
from irsim.components.shapes.rectangle import Rectangle
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.scenario.checks._outlines import segment_gap
from irsim.scenario.read import read
from irsim.scenario.resolve.body_size import inner_disc, thickness

BASE = {
    "kinematics": {"name": "diff"},
    "shape": {"name": "circle", "radius": 0.2},
    "behavior": {"name": "dash"},
    "state": [1, 1, 0],
    "goal": [9, 9],
}
POST = {"shape": {"name": "circle", "radius": 0.3}, "state": [5, 5, 0]}
WALL = {"shape": {"name": "rectangle", "length": 0.1, "width": 6}, "state": [5, 5, 0]}

ROOM_IN_CM = [[0, 0], [1000, 0], [1000, 800], [0, 800], [0, 0]]
FAST = {"vel_max": [5, 1], "vel_min": [0, -1], "goal_threshold": 0.3}
LONG_WALL = {"shape": {"name": "rectangle", "length": 0.05, "width": 8}, "state": [7, 5, 0]}


def codes(data: Any) -> set[str]:
    return {d.code for d in read(data, strict=True).diagnostics}


def line(*vertices: list[float]) -> dict[str, Any]:
    return {"shape": {"name": "linestring", "vertices": [*vertices]}, "state": [0, 0, 0]}


LINE = line([0, 5], [10, 5])


def one(robot: dict[str, Any], *obstacles: dict[str, Any], **world: Any) -> dict[str, Any]:
    return {"world": world, "robot": [{**BASE, **robot}], "obstacle": list(obstacles)}


def both(robot: dict[str, Any], second: dict[str, Any]) -> dict[str, Any]:
    return {"robot": [{**BASE, **robot}, {**BASE, **second}]}


CAR = {"name": "acker", "wheelbase": 0.3}
OMNI = {"name": "omni"}
DRAWN = {"distribution": {"name": "random"}, "goal": None, "state": None}
THREE = {"number": 3, "state": [[1, 1, 0], [1, 3, 0], [1, 5, 0]], "goal": [[9, 1], [9, 3], [9, 5]]}
SIDEWAYS = {"kinematics": OMNI, "vel_max": [0, 1], "vel_min": [0, -1]}
QUICK = {"vel_max": [8, 1], "vel_min": [-8, -1]}
FOUND = [
    (one({"goal": [1.05, 1]}), "goal-reached"),
    (one({"goal": [1.05, 1, 0.05], "arrive_mode": "state", "kinematics": {"name": "omni_angular"}}), "goal-reached"),
    (one({"goal": None, "waypoints": [[3, 3], [3, 3.05], [5, 5]]}), "goal-reached"),
    (one({"static": True}), "static-behavior"),
    (one({"static": True, "behavior": None, "group_behavior": {"name": "orca"}}), "static-behavior"),
    (one({"vel_max": [0, 1], "vel_min": [0, -1], "behavior": None, "group_behavior": {"name": "sfm"}}), "no-speed"),
    (one({"kinematics": None, "behavior": None, "group_behavior": {"name": "orca"}, **THREE}),
        "behavior-without-kinematics"),
    (one({**DRAWN, "goal_threshold": 30}), "goal-reached"),
    (one({**DRAWN, "goal_threshold": 7}), "goal-reached"),
    (one({"goal": None, "behavior": {"name": "dash", "wander": True}, "goal_threshold": 30}), "goal-reached"),
    (one({"unobstructed": True}, {**POST, "state": [5, 2, 0]}), "unobstructed-robot"),
    (one({"kinematics": {**CAR, "psi_max": 30}}), "steering-limit"),
    (one({"kinematics": {**CAR, "mode": "angular", "psi_max": 30}}), "steering-limit"),
    (one({"kinematics": {**CAR, "mode": "angular"}, "vel_max": [1, 30], "vel_min": [-1, -30]}), "rate-in-degrees"),
    (one({"sensors": [{"name": "lidar2d", "noise": True, "angle_std": 5}]}), "heading-in-degrees"),
    (one({"sensors": [{"name": "lidar2d", "range_max": 1000}]}), "looks-like-centimetres"),
    (one({"vel_max": [0, 1], "vel_min": [0, -1]}), "no-speed"),
    (one({"vel_max": [0, 1], "vel_min": [-1, -1]}), "no-speed"),
    (one({"vel_max": [0, 0], "vel_min": [0, 0], "kinematics": {"name": "omni"}}), "no-speed"),
    (one({"vel_max": [0, 0], "kinematics": {"name": "omni"}}), "no-speed"),
    (one({**SIDEWAYS, "goal": [9, 1]}), "no-speed"),
    (one({**SIDEWAYS, "goal": None, "waypoints": [[1, 5], [9, 5]]}), "no-speed"),
    (one({"vel_max": [1, 1], "vel_min": [0, 0], "kinematics": OMNI, "state": [9, 9, 0], "goal": [1, 1]}), "no-speed"),
    (one({"goal_threshold": 0}), "goal-overshoot"),
    (one({"kinematics": None, "behavior": None}), "behavior-without-kinematics"),
    ({"obstacle": [{**BASE, "behavior": None}]}, "no-behavior"),
    (one({**THREE, "name": ["a", "b", "c", "d"]}), "surplus-states"),
    (one({"color": ["r", "b"]}), "surplus-states"),
    (one({"acce": [0, 1]}), "no-speed"),
    (one({"vel_max": [1, 0], "vel_min": [-1, 0]}), "no-turning"),
    (one({"vel_max": [1, 0], "vel_min": [-1, 0], "kinematics": CAR}), "no-turning"),
    (one({"behavior": {"name": "rvo", "target_roles": "robot"}}, POST), "target-roles-nobody"),
    (one({"behavior": {"name": "sfm", "target_roles": "obstacle"}}), "target-roles-nobody"),
    (one({"behavior": {"name": "rvo", "target_roles": "obstacle"}}, {**POST, "unobstructed": True}),
        "target-roles-nobody"),
    (one({"behavior": {"name": "dash", "target_roles": "robot"}}), "ignored-key"),
    (one(QUICK, WALL), "jumps-through"),
    (one({"vel_max": [1, 1]}, WALL, step_time=0.6), "jumps-through"),
    (one({**QUICK, "unobstructed": True}, WALL), "jumps-through"),
    (both({"vel_max": [9, 1], "vel_min": [-9, -1]}, {"state": [9, 9, 0], "goal": [1, 1]}), "jumps-through"),
    (one({**FAST, "goal": [9, 1]}, LONG_WALL), "jumps-through"),
    (one({**FAST, "goal": None, "waypoints": [[5, 1], [5, 8]]}, LONG_WALL), "jumps-through"),
    (one({**FAST, "behavior": {"name": "dash", "wander": True}, "goal": None}, LINE), "jumps-through"),
    (one({**FAST, "goal": [9, 1], "behavior": {"name": "orca"}}, LINE), "jumps-through"),
    (one({**FAST, "goal": [1, 9], "state": [1, 1, -2]}, LINE), "jumps-through"),
    (one({**FAST, "goal": [9, 1], "kinematics": {"name": "diff", "noise": True}}, LINE), "jumps-through"),
    (one({**FAST, "goal": [9, 1], "behavior": {"name": "dash", "loop": True}}, LINE), "jumps-through"),
    (one({**FAST, "state": [2, 5, 0], "goal": [9.5, 5]}, boundary="walls"), "jumps-through"),
    (one({**FAST, "behavior": {"name": "orca"}}, boundary="walls"), "jumps-through"),
    (one({"vel_max": [3, 1], "vel_min": [-3, -1]}), "goal-overshoot"),
    (one({"vel_max": [1, 90], "vel_min": [-1, -90]}), "rate-in-degrees"),
    (one({"vel_max": [80, 1], "vel_min": [-80, -1]}), "speed-in-centimetres"),
    (one({"shape": {"name": "circle", "radius": 20}, "state": [5, 5, 0]}), "looks-like-centimetres"),
    (one({}, line(*ROOM_IN_CM)), "looks-like-centimetres"),
    (one({}, {**line([0, 0], [0, 300]), "state": [500, 0, 0]}), "looks-like-centimetres"),
    (one({}, {"shape": {"name": "polygon", "vertices": [[500, 0], [505, 0], [505, 300]]}, "state": [0, 0, 0]}),
        "looks-like-centimetres"),
    (one({}, step_time=100), "step-time-long"),
    (one({"sensors": [{"name": "lidar2d", "range_max": 0.15}]}), "lidar-blind"),
    (one({"sensors": [{"name": "lidar2d", "angle_range": 1.5e-5}]}), "lidar-beams"),
    (one({"sensors": [{"name": "lidar2d", "offset": [0, 0, 90]}]}), "heading-in-degrees"),
    (one({**DRAWN, "distribution": {"name": "random", "range_low": [1, 1, -180]}}), "heading-in-degrees"),
    (one({"behavior": {"name": "rvo", "wander": True, "range_low": [1, 1, 0], "range_high": [9, 9, 180]}}),
        "heading-in-degrees"),
]  # fmt: skip
SANE = [
    one({}, POST),
    one({**DRAWN, "goal_threshold": 2}),
    one({"unobstructed": True}),
    one({"unobstructed": True}, {**POST, "unobstructed": True}),
    one({"unobstructed": True}, POST, collision_mode="unobstructed"),
    one({"kinematics": {**CAR, "psi_max": 1.5708}}),
    one({"sensors": [{"name": "lidar2d", "noise": True, "angle_std": 0.2}]}),
    one({"goal": [1.15, 1]}),
    one({"goal": [1.05, 1, 1.5], "arrive_mode": "state", "kinematics": {"name": "omni_angular"}}),
    one({"goal": [1, 1], "behavior": {"name": "dash", "loop": True}}),
    one({"goal": None, "behavior": {"name": "dash", "wander": True}}),
    one({"static": True, "behavior": None}),
    one({"vel_max": [1, 0.5], "vel_min": [0, -0.5]}, POST),
    one({**SIDEWAYS, "goal": [1.05, 9]}),
    one({**SIDEWAYS, "state": [1, 1, 1.5708], "goal": [9, 1]}),
    one({"vel_max": [0, 0], "kinematics": {"name": "omni"}, "state": [9, 9, 0], "goal": [1, 1]}),
    one({"vel_max": [0, 1, 1], "vel_min": [0, -1, -1], "kinematics": {"name": "omni_angular"}}),
    one({"goal_threshold": 0, "behavior": None}),
    one({"kinematics": None, "behavior": None, "goal": None}),
    one({"kinematics": None, "behavior": None, "static": True}),
    {"obstacle": [{**BASE, "goal": None, "behavior": None}]},
    {"obstacle": [{**BASE, "behavior": None, "static": True}]},
    both({"number": 2, "name": ["a", "b"], "state": [[1, 1, 0], [1, 3, 0]]}, {"state": [1, 5, 0]}),
    one({"acce": [0.5, 1]}),
    one({"acce": [0, 1], "velocity": [0.5, 0]}),
    one({"behavior": {"name": "rvo", "target_roles": "obstacle"}}, POST),
    both({"behavior": {"name": "rvo", "target_roles": "robot"}}, {"state": [3, 1, 0]}),
    one({"vel_max": [4, 1], "vel_min": [-4, -1], "goal_threshold": 0.3}, WALL),
    one({**QUICK, "goal_threshold": 0.5}, WALL, collision_mode="unobstructed"),
    one({**QUICK, "goal_threshold": 0.5}, {**WALL, "unobstructed": True}),
    one({**QUICK, "goal_threshold": 0.5, "goal": [9, 1]}, {**WALL, "state": [2, 6, 0]}),
    one({}, {**line([-1000, 5.5], [1000, 5.5]), "state": [0, 4, 0]}),
    one({}, line([0, 0], [25, 0], [25, 25])),
    one({**FAST, "goal": [9, 1]}, LINE),
    one({**FAST, "goal": [9, 1], "kinematics": {"name": "omni"}, "vel_max": [5, 5], "vel_min": [-5, -5]}, LINE),
    one({**FAST, "goal": [9, 1]}, {**LONG_WALL, "state": [5, 4, 1.5708]}),
    one({**FAST, "state": [3, 5, 0], "goal": [7, 5]}, boundary="walls"),
    one({**FAST, "state": [0.6, 0.7, 0], "goal": [7, 0.7]}, boundary="walls"),
    one({"vel_max": [2, 3], "vel_min": [-2, -3]}),
    one({"shape": {"name": "circle", "radius": 2}, "state": [3, 3, 0], "goal": [7, 7]}),
    one({"sensors": [{"name": "lidar2d", "range_max": 0.5}]}),
    one({"sensors": [{"name": "lidar2d", "offset": [0.1, 0, 1.57]}]}),
]


@pytest.mark.parametrize(("data", "code"), FOUND, ids=[f"{code}-{i}" for i, (_, code) in enumerate(FOUND)])
def test_finds(data: Any, code: str) -> None:
    reading = read(data, strict=True)
    matching = [d for d in reading.diagnostics if d.code == code]
    assert len(matching) == 1, reading.diagnostics
    assert matching[0].severity in ("warning", "hint")
    assert matching[0].fix


@pytest.mark.parametrize("data", SANE, ids=range(len(SANE)))
def test_says_nothing_of_sane_ones(data: Any) -> None:
    # Some are as fast as the check of tunneling allows, and so coarse for their size.
    assert codes(data) <= {"no-behavior", "coarse-steps"}


def dash(keys: str, world: str = "", drive: str = "diff") -> str:
    """A robot that drives straight, in a world of 10 m x 10 m unless it is given another size."""
    robot = f"kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.2}}, behavior: {{name: dash}}"
    return f"world: {{{world}}}\nrobot: {{{robot}, {keys}}}\n"


def wall(x: float) -> str:
    return f"obstacle: {{shape: {{name: rectangle, length: 0.1, width: 6}}, state: [{x}, 5, 0]}}\n"


def outcome(text: str, steps: int | None = None) -> str:
    return irsim.run(text=text, seed=0, steps=steps).outcome


def finding(text: str, code: str) -> Diagnostic:
    (diagnostic,) = [d for d in read(text).diagnostics if d.code == code]
    return diagnostic


def test_objects_reported_never_to_arrive_do_not_arrive() -> None:
    """Omni drives without the direction of their goal, and a threshold of 0."""
    sideways = "goal: [9, 1], vel_max: [0, 1], vel_min: [0, -1]"
    assert outcome(dash(f"state: [1, 1, 0], {sideways}", drive="omni")) == "timeout"
    assert outcome(dash(f"state: [1, 1, 1.5708], {sideways}", drive="omni")) == "success"
    assert outcome(dash("state: [1, 1, 0], goal: [9, 1], goal_threshold: 0")) == "timeout"


def test_objects_reported_to_hop_over_their_goal_do() -> None:
    """And with the threshold that the fix names it arrives."""
    text = dash("state: [1, 1, 0], goal: [8.03, 7.11], vel_max: [3, 1], vel_min: [-3, -1], goal_threshold: 0.1")
    assert outcome(text) == "timeout"
    assert "goal_threshold: 0.16" in str(finding(text, "goal-overshoot").fix)
    assert outcome(text.replace("goal_threshold: 0.1", "goal_threshold: 0.16")) == "success"


@pytest.mark.parametrize("behavior", ["orca", "avocado", "rvo", "sfm", "footprint_orca"])
def test_goals_that_steps_jump_over_are_told_under_every_behavior(behavior: str) -> None:
    def text(threshold: float, heading: float = 0.0) -> str:
        keys = f"state: [2, 2, {heading}], goal: [9, 8], goal_threshold: {threshold}, behavior: {{name: {behavior}}}"
        return f"world: {{width: 12, height: 12, step_time: 0.5}}\nrobot: {{kinematics: {{name: diff}}, {keys}}}\n"

    def arrivals(threshold: float) -> int:
        return sum(outcome(text(threshold, -3 + 0.5 * start), steps=120) == "success" for start in range(12))

    assert "goal_threshold: 0.26" in str(finding(text(0.1), "goal-overshoot").fix)
    assert arrivals(0.1) < arrivals(0.26) == 12
    assert "goal-overshoot" not in codes(text(0.26))


def test_objects_reported_to_jump_through_a_wall_do() -> None:
    keys = "state: [1, 5, 0], goal: [9, 5], vel_max: [8, 8], vel_min: [-8, -8], goal_threshold: 0.5"
    text = dash(keys, "step_time: 0.1", drive="omni") + wall(5.4)
    assert outcome(text) == "success"
    step = float(str(finding(text, "jumps-through").fix).split()[1])
    assert step == pytest.approx(0.06)
    assert outcome(text.replace("step_time: 0.1", f"step_time: {step}")) == "collision"


def test_what_is_said_to_jump_through_the_walls_round_the_world_leaves_it() -> None:
    """And what is said nothing of, because it drives past a line far to its side, does not touch it."""
    world, limits = "width: 20, height: 20, step_time: 1", "vel_max: [4, 1], vel_min: [0, -1]"
    text = dash(f"state: [1, 5, 0], goal: [18, 5], {limits}, goal_threshold: 0.1", f"{world}, boundary: walls")
    assert "the walls round the world" in finding(text, "jumps-through").message
    assert irsim.run(text=text, seed=0).left
    beside = dash(f"state: [6, 5, 0], goal: [13, 5], {limits}, goal_threshold: 2.1", world) + (
        "obstacle: [{shape: {name: linestring, vertices: [[0, 15], [20, 15]]}, state: [0, 0, 0]}]\n"
    )
    assert "jumps-through" not in codes(beside)
    assert outcome(beside) == "success"


def test_nothing_jumps_where_contacts_within_steps_count() -> None:
    def text(judged: str) -> str:
        keys = "state: [1, 5, 0], goal: [9, 5], vel_max: [2, 1], goal_threshold: 1"
        return dash(keys, f"step_time: 1, {judged}") + wall(5)

    assert "jumps-through" in codes(text("contacts: step_end"))
    for judged in ("contacts: swept", "collision_mode: contact"):
        assert "jumps-through" not in codes(text(judged))
    assert outcome(text("contacts: swept")) == "collision"


def test_the_disc_inside() -> None:
    box = [core.Polygon(vertices=[[-1, -0.5], [3, -0.5], [3, 0.5], [-1, 0.5]])]
    assert inner_disc(box)[2] == pytest.approx(0.5, rel=0.02)
    triangle = [core.Polygon(vertices=[[0, 0], [3, 0], [0, 4]])]
    assert inner_disc(triangle) == pytest.approx((1, 1, 1), rel=0.03)
    notch = [core.Polygon(vertices=[[0, 0], [4, 0], [4, 4], [3, 4], [3, 1], [0, 1]])]
    assert 0.5 <= inner_disc(notch)[2] <= math.sqrt(2) / (1 + math.sqrt(2)) + 1e-9
    assert inner_disc([core.Circle(radius=0.3, center=[1, 0])]) == (1, 0, 0.3)
    assert inner_disc([core.Linestring(vertices=[[0, 0], [1, 1]])])[2] == 0


def test_the_least_extent() -> None:
    assert thickness(Rectangle(length=4, width=0.1)) == pytest.approx(0.1)
    turned = Polygon(vertices=[[0, 0], [3, 3], [2.9, 3.1], [-0.1, 0.1]])
    assert thickness(turned) == pytest.approx(math.sqrt(0.02))


def test_gaps_between_segments() -> None:
    assert segment_gap(((0, 0), (2, 2)), ((0, 2), (2, 0))) == 0
    assert segment_gap(((0, 0), (2, 0)), ((3, 1), (3, -1))) == 1
    assert segment_gap(((0, 0), (0, 0)), ((3, 4), (3, 4))) == 5
