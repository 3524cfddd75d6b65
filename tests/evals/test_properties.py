"""Properties of bodies are what the built world does, whichever keys say it; names come from the registries."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import pytest

from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates.bodies import parameter
from irsim_evals.grader.properties import PROPERTIES, value_of
from tests.evals.conftest import ROOT, graded, made_up, seen, world

CAR = "kinematics: {name: acker, wheelbase: 1%s}, vel_max: [1, %s], vel_min: [-1, %s]"
PAIR = "{kinematics: {name: diff}, state: [%s, 5, 0], goal: [5, 9, 0], behavior: %s}"


def of_robot(keys: str, *names: str) -> list[Any]:
    """Properties of a robot with some keys."""
    scene = world(f"robot: {{{keys}}}").scene(0)
    return [value_of(scene, scene.bodies[0], name) for name in names]


@pytest.mark.parametrize(
    ("car", "left", "right"),
    [
        (CAR % ("", 0.4, -0.2), 0.4, 0.2),
        (CAR % (", psi_max: 0.3", 0.5, -0.5), 0.3, 0.3),
        (CAR % (", psi_max: 0.3", 0.5, 0.1), 0.3, 0.0),
        (CAR % (", mode: angular, psi_max: 0.3", 0.5, -0.5), 0.3, 0.3),  # the second control is a rate there
        (CAR % (", mode: angular", 0.5, -0.5), None, None),
    ],
)
def test_a_steering_angle_is_what_limits_and_drive_leave(car: str, left: float | None, right: float | None) -> None:
    angles = of_robot(car, "steer_left", "steer_right", "steer")
    assert angles == pytest.approx([left, right, left])


@pytest.mark.parametrize(
    ("keys", "name", "value"),
    [
        ("kinematics: {name: omni_angular}, vel_max: [1, 2, 0.5], vel_min: [-1, -3, -0.7]", "turn", 0.7),
        ("kinematics: {name: omni_angular}, vel_max: [1, 2, 0.5], vel_min: [-1, -3, -0.7]", "leftward", 2.0),
        ("kinematics: {name: omni}, vel_max: [1, 2], vel_min: [-1, -3]", "turn_left", None),
        ("kinematics: {name: diff}, vel_max: [2, 1], behavior: {name: orca, maxSpeed: 0.5}", "forward", 0.5),
        ("kinematics: {name: diff}, vel_max: [2, 1], behavior: {name: follow, local: {name: orca, maxSpeed: 0.5}}",
         "forward", 0.5),
        ("kinematics: {name: acker}", "wheelbase", 1.0),  # as the drive counts it
        ("kinematics: {name: diff}, behavior: {name: dash, loop: true, wander: true}", "loop", False),
        ("kinematics: {name: diff}, static: true, behavior: {name: dash, wander: true}", "wander", False),
        ("kinematics: {name: diff}, behavior: {name: dash}, group_behavior: {name: orca}", "behavior", "orca"),
        ("kinematics: {name: diff}, acce: [0.5, 2]", "acce", 0.5),
        ("kinematics: {name: omni_angular}, acce: [0.5, 1, 2]", "turn_acce", 2.0),
        ("kinematics: {name: omni}, acce: [0.5, 1]", "turn_acce", None),
        ("kinematics: {name: diff}", "acce", None),
        ("kinematics: {name: diff, noise: true}", "noise", True),
        ("kinematics: {name: diff, noise: true, alpha: [0, 0, 0, 0]}", "noise", False),
        ("kinematics: {name: diff, alpha: [1, 1, 1, 1]}", "noise", False),
        ("kinematics: {name: diff}, fov: 2, fov_radius: 3, plot: {show_fov: true}", "show_fov", True),
        ("kinematics: {name: diff}, plot: {show_fov: true}", "show_fov", False),
        ("kinematics: {name: diff}, fov: 2, fov_radius: 3", "fov", 2.0),
        ("kinematics: {name: diff}, fov: 2, sensors: [{name: lidar2d, range_max: 4}]", "fov_radius", 4.0),
        ("kinematics: {name: diff}, sensors: [{name: lidar2d}]", "fov", None),  # a lidar alone is not a field of view
        ("kinematics: {name: diff}, sensors: [{name: lidar2d}]", "fov_radius", None),
    ],
)  # fmt: skip
def test_a_property_is_what_the_built_world_does(keys: str, name: str, value: Any) -> None:
    [actual] = of_robot(keys, name)
    assert actual == (pytest.approx(value) if isinstance(value, float) else value)


def _forms() -> list[tuple[str, bool]]:
    """Each behavior alone, and as the local one of ``follow`` → whether it is declared to avoid others."""
    options: list[Any] = [feature.options for feature in BEHAVIORS.features() if feature.origin == "built-in"]
    names = {kind: kind.model_fields["name"].default for kind in options if kind.needs_goal}
    alone = [(f"{{name: {name}}}", kind.avoids and kind.follows_paths) for kind, name in names.items()]
    return alone + [
        (f"{{name: follow, local: {{name: {name}}}}}", kind.avoids)
        for kind, name in names.items()
        if kind.follows_paths
    ]


@pytest.mark.parametrize(("behavior", "avoids"), _forms())
def test_a_body_avoids_if_its_behavior_is_declared_to(behavior: str, avoids: bool) -> None:
    """A planner avoids others if what drives it does."""
    assert of_robot(f"kinematics: {{name: diff}}, behavior: {behavior}", "avoids") == [avoids]


@pytest.mark.parametrize(("roles", "avoids"), [("all", True), ("robot", True), ("obstacle", False)])
def test_a_body_that_is_told_to_avoid_nobody_there_is_avoids_nobody(roles: str, avoids: bool) -> None:
    behavior = f"{{name: orca, target_roles: {roles}}}"
    scene = world(f"robot: [{PAIR % (2, behavior)}, {PAIR % (8, behavior)}]").scene(0)
    assert value_of(scene, scene.bodies[0], "avoids") == avoids


@pytest.mark.parametrize(
    ("keys", "name", "value"),
    [
        ("number: 4, angle_range: 2, endpoint: false", "spacing", 0.5),
        ("number: 5, angle_range: 2", "spacing", 0.5),
        ("std: 0.1", "std", 0.0),
        ("std: 0.1, noise: true", "std", 0.1),
        ("std: 0, noise: true", "noise", False),
        ("std: 0, angle_std: 0.1, noise: true", "noise", True),
    ],
)
def test_a_sensor_is_what_it_measures(keys: str, name: str, value: Any) -> None:
    scene = world(f"robot: {{kinematics: {{name: diff}}, sensors: [{{name: lidar2d, {keys}}}]}}").scene(0)
    [sensor] = scene.bodies[0].sensors
    assert parameter(sensor, name) == pytest.approx(value)


@pytest.mark.parametrize(("offset", "right", "top"), [("", 12.0, 8.0), (", offset: [-2, 1]", 10.0, 9.0)])
def test_a_world_has_four_edges(offset: str, right: float, top: float) -> None:
    case = made_up({"id": "edges", "world": {"right": {"eq": right, "tol": 0}, "top": {"eq": top, "tol": 0}}})
    assert graded(case, f"world: {{width: 12, height: 8{offset}}}\nrobot: {{kinematics: {{name: diff}}}}").strict


HALL = """
world: {width: 10, height: 6}
robot:
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 0.9, width: 0.6}, state: [2, 3, 0], goal: [8, 3]}
  - {kinematics: {name: diff}, shape: {name: rectangle, length: 0.9, width: %s}, state: [2, 1, 0], goal: [8, 1]}
obstacle:
  - {shape: {name: rectangle, length: 0.2, width: 2.6}, state: [5, 1.3, 0]}
  - {shape: {name: rectangle, length: 0.2, width: 2.6}, state: [5, 4.7, 0]}
"""


@pytest.mark.parametrize(
    ("width", "limit", "passes"),
    [
        (0.6, {"ge": "= robots.width + 0.1"}, True),
        (0.6, {"ge": "= robots.width + 0.3"}, False),
        (0.75, {"ge": "= robots.width + 0.1"}, False),  # it holds for each of them, the wider one too
        (0.75, {"le": "= robots.width + 0.1"}, False),  # the narrower one too
        (0.6, "= robots.width + 0.2", True),
        (0.75, "= robots.width + 0.2", False),  # the robots have two widths, not a single value
        (0.6, {"eq": "= world.width / 10 - 0.2", "tol": 0.001}, True),
        (0.6, {"ge": "= statics.radius"}, False),  # rectangles have no radius
    ],
)
def test_a_measured_value_may_depend_on_the_answer(width: float, limit: Any, passes: bool) -> None:
    case = made_up({"id": "gap", "spacing": {"of": "obstacles", "what": "footprint", "distance": limit}})
    assert graded(case, HALL % width).strict == passes


@pytest.mark.parametrize(
    ("relation", "problem"),
    [
        ("= robots.widht", "there is no property 'widht'"),
        ("= robot.width", "there is no selection 'robot'"),
        ("= world.widht", "there is no property of the world 'widht'"),
        ("= 2 + 3", "names no property"),
        ("= robots.width.real", "cannot contain"),
        ("= __import__(robots.width)", "cannot contain"),
    ],
)
def test_a_relation_that_means_nothing_is_refused_when_the_case_is_read(relation: str, problem: str) -> None:
    with pytest.raises(ValueError, match=re.escape(problem)):
        made_up({"id": "gap", "count": {"of": "obstacles", "number": {"ge": relation}}})


def test_a_file_has_no_world_to_relate_to() -> None:
    with pytest.raises(ValueError, match="no world"):
        made_up({"id": "many", "files": {"pattern": "*", "number": {"ge": "= robots.width"}}})


@pytest.mark.parametrize(("value", "accepted"), [(0.0, True), (None, True), (1.0, False)])
def test_no_value_may_be_as_good_as_zero(value: float | None, accepted: bool) -> None:
    match = Match.model_validate({"eq": 0, "or_none": True})
    assert matches(match, value, "speed") == accepted
    assert match.words() == "0 or none"


def test_no_value_of_any_property_may_be_as_good_as_a_value() -> None:
    """Where a body lacks a property, or a sensor a parameter, it is None, which `or_none` accepts."""
    body = "kinematics: {name: diff}, sensors: [{name: contact2d}]"
    for name, one in PROPERTIES.items():
        [value] = of_robot(body, name)
        assert value is None or value == value, name
        if value is None:
            assert matches(Match.model_validate({"eq": 0, "or_none": True}), value, one.kind), name
    observation = seen(
        world(f"robot: {{{body}}}"), "sensor", {"of": "robots", "has": {"range_max": {"eq": 3, "or_none": True}}}
    )
    assert observation.passed


REGISTERED = {name for registry in (BEHAVIORS, KINEMATICS) for name in registry.names()} - {"static"}


def _lists_of_names(path: Path) -> list[str]:
    """Literal lists, tuples, sets and sums of conditions with two or more names of behaviors or drives."""
    lists = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, (ast.List, ast.Tuple, ast.Set)):
            items = node.elts
        elif isinstance(node, ast.Dict):
            items = [key for key in node.keys if key is not None]
        else:
            continue
        names = [item.value for item in items if isinstance(item, ast.Constant) and item.value in REGISTERED]
        if len(names) > 1:
            lists.append(f"{path.relative_to(ROOT)}:{node.lineno}: {', '.join(names)}")
    return lists


def test_no_list_of_behaviors_or_drives_stands_beside_the_registry() -> None:
    files = [*(ROOT / "evals/irsim_evals").rglob("*.py"), *(ROOT / "mcp_server/irsim_mcp").rglob("*.py")]
    assert len(files) > 50
    assert [line for path in files for line in _lists_of_names(path)] == []
