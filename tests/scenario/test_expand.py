"""From a scenario to one record per object: numbers, names, groups, defaults."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.options.colors import CYCLE
from irsim.scenario.read import read
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

DIFF = {"kinematics": {"name": "diff"}}


def resolved(data: dict[str, Any]) -> ResolvedScenario:
    scenario = read(data).scenario
    assert scenario is not None, read(data).diagnostics
    return scenario


def one(**keys: Any) -> ObjectRecord:
    return resolved({"robot": keys}).objects[0]


def test_ids_names_and_groups_of_lists() -> None:
    scenario = resolved({"robot": [DIFF, {**DIFF, "number": 2, "group": 7}], "obstacle": [{}, {"number": 2}]})
    rows = [(o.id, o.role, o.name, o.group, o.group_name, o.path, o.index) for o in scenario.objects]
    assert rows == [
        (0, "robot", "robot_0", 0, "robot_0", ("robot", 0), 0),
        (1, "robot", "robot_1", 7, "robot_7", ("robot", 1), 0),
        (2, "robot", "robot_2", 7, "robot_7", ("robot", 1), 1),
        (3, "obstacle", "obstacle_3", 8, "obstacle_8", ("obstacle", 0), 0),
        (4, "obstacle", "obstacle_4", 9, "obstacle_9", ("obstacle", 1), 0),
        (5, "obstacle", "obstacle_5", 9, "obstacle_9", ("obstacle", 1), 1),
    ]


@pytest.mark.parametrize(
    ("data", "groups"),
    [
        ({"robot": {"number": 2}, "obstacle": {"number": 2}}, [0, 0, 0, 0]),
        ({"obstacle": [{}, {}]}, [0, 1]),
        ({"robot": [{"number": 0}], "obstacle": [{}, {}]}, [0, 1]),
        ({"robot": [{"group": -5}], "obstacle": [{}, {}]}, [-5, -4, -3]),
        ({"robot": {"group": 3}, "obstacle": {}}, [3, 0]),
    ],
)
def test_group_numbers(data: dict[str, Any], groups: list[int]) -> None:
    assert [o.group for o in resolved(data).objects] == groups


def test_defaults_of_a_bare_object() -> None:
    record = one()
    assert record.state == [1, 1, 0]
    assert record.goals == [[1, 9, 0]]
    assert getattr(record.shape, "radius", None) == 1
    assert record.kinematics is None
    assert record.static
    assert (record.mass, record.friction, record.restitution, record.inertia) == (math.inf, 0.5, 0, None)
    assert (record.color, record.description) == ("k", None)
    assert (record.fov, record.fov_radius, record.wheelbase) == (None, None, None)
    assert record.sensors == []
    assert not record.wander
    assert record.target_roles == "all"


@pytest.mark.parametrize(
    ("name", "state", "vel"), [("diff", 3, 2), ("omni", 3, 2), ("omni_angular", 3, 3), ("acker", 4, 2)]
)
def test_dimensions_and_limits(name: str, state: int, vel: int) -> None:
    record = one(kinematics={"name": name})
    assert (record.state_dim, record.vel_dim, len(record.state)) == (state, vel, state)
    assert record.vel_min == [-1] * vel
    assert record.vel_max == [1] * vel
    assert record.acce == [math.inf] * vel
    assert record.velocity == [0] * vel
    assert record.angle_range == (-math.pi, math.pi)
    assert not record.static
    assert record.mass == 1


@pytest.mark.parametrize(
    ("keys", "state"),
    [
        ({"state": [5]}, [5, 0, 0]),
        ({"state": []}, [0, 0, 0]),
        ({"state": [5, 6]}, [5, 6, 0]),
        ({"state": [5, 6, 7, 8]}, [5, 6, 7]),
        ({"state": [5, 6, 7, 8], "kinematics": {"name": "acker"}}, [5, 6, 7, 8]),
        ({"state": [5, 6, 7], "kinematics": {"name": "acker"}}, [5, 6, 7, 0]),
        ({"state": [1, 2, 3, 4, 5], "state_dim": 5}, [1, 2, 3, 4, 5]),
        ({"state": None}, [1, 1, 0]),
    ],
)
def test_states_are_padded_and_cut(keys: dict[str, Any], state: list[float]) -> None:
    assert one(**keys).state == state


@pytest.mark.parametrize(
    ("goal", "goals"),
    [
        ([5, 6], [[[5, 6]]] * 3),
        ([[5, 6], [7, 8]], [[[5, 6]], [[7, 8]], [[7, 8]]]),
        ([[[5, 6], [7, 8]]], [[[5, 6], [7, 8]]] * 3),
        ([[[5, 6], [7, 8]], [1, 2]], [[[5, 6], [7, 8]], [[1, 2]], [[1, 2]]]),
        ([None, [1, 2]], [[], [[1, 2]], [[1, 2]]]),
        (None, [[[1, 9, 0]]] * 3),
    ],
)
def test_goals(goal: Any, goals: list[list[list[float]]]) -> None:
    scenario = resolved({"robot": {**DIFF, "number": 3, "goal": goal, "state": [[1, 1], [2, 2], [3, 3]]}})
    assert [o.goals for o in scenario.objects] == goals


def test_waypoints() -> None:
    assert one(waypoints=[[1, 2], [3, 4, 0]]).goals == [[1, 2], [3, 4, 0]]
    scenario = resolved({"robot": {"number": 2, "waypoints": [[[1, 2], [3, 4]], [[5, 6]]], "state": [[1, 1], [2, 2]]}})
    assert [o.goals for o in scenario.objects] == [[[1, 2], [3, 4]], [[5, 6]]]


@given(st.integers(1, 12), st.floats(0.5, 8), st.floats(-20, 20), st.floats(-20, 20))
def test_circle_distribution(count: int, radius: float, cx: float, cy: float) -> None:
    entry = {**DIFF, "number": count, "distribution": {"name": "circle", "radius": radius, "center": [cx, cy]}}
    for i, record in enumerate(resolved({"robot": entry}).objects):
        angle = 2 * math.pi * i / count
        x, y, heading = record.state
        assert (x, y) == pytest.approx((cx + radius * math.cos(angle), cy + radius * math.sin(angle)))
        assert -math.pi <= heading < math.pi
        assert math.cos(heading - (angle - math.pi)) == pytest.approx(1)
        (goal,) = record.goals
        assert goal[:2] == pytest.approx([2 * cx - x, 2 * cy - y])
        assert goal[2] == heading


def test_circle_defaults_and_own_goal() -> None:
    world = {"width": 20, "height": 8, "offset": [-10, 2]}
    data = {"world": world, "robot": {**DIFF, "number": 2, "distribution": {"name": "circle"}}}
    first = resolved(data).objects[0]
    assert first.state == pytest.approx([3.5, 6, -math.pi])
    assert first.goals[0] == pytest.approx([-3.5, 6, -math.pi])
    data["robot"]["goal"] = [0, 0]
    assert resolved(data).objects[1].goals == [[0, 0]]


def test_random_distribution_is_a_placement() -> None:
    scenario = resolved(
        {
            "world": {"width": 20, "height": 8, "offset": [-10, 2]},
            "robot": [DIFF, {**DIFF, "number": 3, "distribution": {"name": "random"}}],
            "obstacle": {"number": 2, "distribution": {"name": "random", "range_low": [0, 3, 0], "min_distance": 0.2}},
        }
    )
    first, second = scenario.placements
    assert first.objects == [1, 2, 3]
    assert first.range_low == [-9.5, 2.5, -math.pi]
    assert first.range_high == [9.5, 9.5, math.pi]
    assert first.min_distance == 1.0
    assert first.path == ("robot", 1)
    assert second.objects == [4, 5]
    assert (second.range_low, second.min_distance) == ([0, 3, 0], 0.2)
    assert scenario.objects[1].goals == []


def test_wander_box_is_the_world_unless_given() -> None:
    data: dict[str, Any] = {
        "world": {"width": 30, "height": 20, "offset": [-5, 5]},
        "robot": {**DIFF, "behavior": {"name": "dash", "wander": True}},
    }
    record = resolved(data).objects[0]
    assert record.wander
    assert record.range_low == [-5, 5, -math.pi]
    assert record.range_high == [25, 25, math.pi]
    data["robot"]["behavior"].update(range_low=[0, 6], range_high=[1, 7, 1])
    record = resolved(data).objects[0]
    assert (record.range_low, record.range_high) == ([0, 6, -math.pi], [1, 7, 1])


@pytest.mark.parametrize(
    ("role", "keys", "color"),
    [
        ("robot", DIFF, "#009E73"),
        ("robot", {"kinematics": {"name": "acker"}}, "#117733"),
        ("robot", {**DIFF, "static": True}, "#009E73"),
        ("robot", {}, "k"),
        ("robot", {"mass": 2}, "#E69F00"),
        ("obstacle", DIFF, "k"),
        ("obstacle", {"mass": 2}, "#E69F00"),
        ("obstacle", {"mass": 2, "static": True}, "k"),
        ("obstacle", {"mass": math.inf}, "k"),
        ("obstacle", {"color": [0.5, 0.5, 1]}, (0.5, 0.5, 1)),
    ],
)
def test_default_colors(role: str, keys: dict[str, Any], color: Any) -> None:
    assert resolved({role: keys}).objects[0].color == color


def test_cycle_starts_anew_with_every_entry() -> None:
    entry = {**DIFF, "number": 10, "color": "cycle", "distribution": {"name": "random"}}
    colors = [o.color for o in resolved({"robot": [entry, entry]}).objects]
    assert colors[:8] == list(CYCLE)
    assert colors[8:10] == list(CYCLE[:2])
    assert colors[10:] == colors[:10]
    listed = {**entry, "number": 3, "color": ["cycle", "r"]}
    assert [o.color for o in resolved({"robot": listed}).objects] == [CYCLE[0], "r", "r"]


def test_pictures() -> None:
    assert one(kinematics={"name": "acker"}).description == "car_green.png"
    assert one(kinematics={"name": "acker"}, description="mine.png").description == "mine.png"
    assert resolved({"obstacle": {"kinematics": {"name": "acker"}}}).objects[0].description is None


@pytest.mark.parametrize(
    ("keys", "view"),
    [
        ({}, (None, None)),
        ({"fov": 1.0, "fov_radius": 2}, (1.0, 2)),
        ({"fov": 6.2832, "fov_radius": 2}, (2 * math.pi, 2)),
        ({"fov_radius": 2}, (None, None)),
        ({"sensors": [{}]}, (math.pi, 10)),
        ({"sensors": [{}], "fov_radius": 2}, (math.pi, 10)),
        ({"sensors": [{}], "fov": 1.0}, (1.0, 10)),
        ({"sensors": [{"angle_range": 6.2832, "range_max": 4}]}, (2 * math.pi, 4)),
    ],
)
def test_field_of_view(keys: dict[str, Any], view: tuple[float | None, float | None]) -> None:
    record = one(**keys)
    assert (record.fov, record.fov_radius) == view


def test_sensors_for_all_or_each() -> None:
    lidar = {"name": "lidar2d", "number": 5}
    states = [[1, 1], [2, 2], [3, 3]]
    for_all = resolved({"robot": {"number": 3, "state": states, "sensors": [lidar, lidar]}})
    assert [len(o.sensors) for o in for_all.objects] == [2, 2, 2]
    each = resolved({"robot": {"number": 3, "state": states, "sensors": [[lidar], []]}})
    assert [len(o.sensors) for o in each.objects] == [1, 0, 0]


def test_wheelbase_of_kinematics_first() -> None:
    shape = {"name": "rectangle", "wheelbase": 3}
    assert one(kinematics={"name": "acker"}, shape=shape).wheelbase == 3
    assert one(kinematics={"name": "acker", "wheelbase": 2}, shape=shape).wheelbase == 2


def test_world_values_are_defaults_of_objects() -> None:
    scenario = resolved({"world": {"friction": 0.2, "restitution": 0.7}, "obstacle": [{}, {"friction": 0.9}]})
    assert [(o.friction, o.restitution) for o in scenario.objects] == [(0.2, 0.7), (0.9, 0.7)]


def test_name_of_the_world() -> None:
    assert resolved({}).name == "world"
    assert resolved({"world": {"name": "yard"}}).name == "yard"
    reading = read("world: {height: 3}\n", name="/some/where/yard.v2.yaml")
    assert reading.scenario is not None
    assert reading.scenario.name == "yard"


def test_document_is_kept_as_written() -> None:
    text = "world: {height: 3, unknown: 1}\ncustom: {a: [1]}\n"
    scenario = read(text).scenario
    assert scenario is not None
    assert scenario.document == {"world": {"height": 3, "unknown": 1}, "custom": {"a": [1]}}
    assert scenario.custom == {"a": [1]}
    assert scenario.text == text


def test_tags() -> None:
    assert one(tags=["pedestrian"]).tags == ("pedestrian",)
    scenario = resolved({"robot": {"number": 2, "tags": [["a"], ["b", "c"]], "state": [[1, 1], [2, 2]]}})
    assert [o.tags for o in scenario.objects] == [("a",), ("b", "c")]


def test_nothing_is_shared_that_changes() -> None:
    scenario = resolved({"robot": {**DIFF, "number": 2, "vel_max": [2, 2], "distribution": {"name": "circle"}}})
    first, second = scenario.objects
    first.vel_max[0] = 9
    first.state[0] = 9
    first.goals[0][0] = 9
    assert second.vel_max == [2, 2]
    assert second.state[0] != 9
    assert second.goals[0][0] != 9
