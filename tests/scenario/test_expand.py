"""From a scenario to one record per object: values spread over them, numbers, names, groups, defaults."""

from __future__ import annotations

import copy
import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from irsim.components.shapes.circle import Circle
from irsim.options.colors import CYCLE
from irsim.scenario.read import read
from irsim.scenario.resolve.per_object import kind_of, spread
from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

DIFF = {"kinematics": {"name": "diff"}}
WIDE = {"width": 20, "height": 8, "offset": [-10, 2]}


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


ACKER = {"kinematics": {"name": "acker"}}
LONG = {"name": "rectangle", "wheelbase": 3}
BARE = {
    "state": [1, 1, 0], "goals": [[1, 9, 0]], "shape": Circle(radius=1), "kinematics": None, "static": True,
    "mass": math.inf, "friction": 0.5, "restitution": 0, "inertia": None, "color": "k", "description": None,
    "sensors": [], "fov": None, "fov_radius": None, "wheelbase": None, "wander": False, "target_roles": "all",
}  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({}, BARE),
        ({"state": [5]}, {"state": [5, 0, 0]}),
        ({"state": []}, {"state": [0, 0, 0]}),
        ({"state": [5, 6]}, {"state": [5, 6, 0]}),
        ({"state": [5, 6, 7, 8]}, {"state": [5, 6, 7]}),
        ({"state": [5, 6, 7, 8], **ACKER}, {"state": [5, 6, 7, 8]}),
        ({"state": [5, 6, 7], **ACKER}, {"state": [5, 6, 7, 0]}),
        ({"state": [1, 2, 3, 4, 5], "state_dim": 5}, {"state": [1, 2, 3, 4, 5]}),
        ({"state": None}, {"state": [1, 1, 0]}),
        ({"waypoints": [[1, 2], [3, 4, 0]]}, {"goals": [[1, 2], [3, 4, 0]]}),
        ({"fov": 1.0, "fov_radius": 2}, {"fov": 1.0, "fov_radius": 2}),
        ({"fov": 6.2832, "fov_radius": 2}, {"fov": 2 * math.pi, "fov_radius": 2}),
        ({"fov_radius": 2}, {"fov": None, "fov_radius": None}),
        ({"sensors": [{}]}, {"fov": math.pi, "fov_radius": 10}),
        ({"sensors": [{}], "fov_radius": 2}, {"fov": math.pi, "fov_radius": 10}),
        ({"sensors": [{}], "fov": 1.0}, {"fov": 1.0, "fov_radius": 10}),
        ({"sensors": [{"angle_range": 6.2832, "range_max": 4}]}, {"fov": 2 * math.pi, "fov_radius": 4}),
        (ACKER, {"description": "car_green.png"}),
        ({**ACKER, "description": "mine.png"}, {"description": "mine.png"}),
        ({**ACKER, "shape": LONG}, {"wheelbase": 3}),
        ({"kinematics": {"name": "acker", "wheelbase": 2}, "shape": LONG}, {"wheelbase": 2}),
        ({"tags": ["pedestrian"]}, {"tags": ("pedestrian",)}),
    ],
    ids=str,
)
def test_what_follows_from_the_keys_of_a_robot(keys: dict[str, Any], expected: dict[str, Any]) -> None:
    record = one(**keys)
    assert {key: getattr(record, key) for key in expected} == expected


@pytest.mark.parametrize(
    ("name", "state", "vel"), [("diff", 3, 2), ("omni", 3, 2), ("omni_angular", 3, 3), ("acker", 4, 2)]
)
def test_dimensions_and_limits(name: str, state: int, vel: int) -> None:
    record = one(kinematics={"name": name})
    assert (record.state_dim, record.vel_dim, len(record.state)) == (state, vel, state)
    assert (record.vel_min, record.vel_max) == ([-1] * vel, [1] * vel)
    assert (record.acce, record.velocity) == ([math.inf] * vel, [0] * vel)
    assert (record.angle_range, record.static, record.mass) == ((-math.pi, math.pi), False, 1)


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
    data = {"world": WIDE, "robot": {**DIFF, "number": 2, "distribution": {"name": "circle"}}}
    first = resolved(data).objects[0]
    assert first.state == pytest.approx([3.5, 6, -math.pi])
    assert first.goals[0] == pytest.approx([-3.5, 6, -math.pi])
    data["robot"]["goal"] = [0, 0]
    assert resolved(data).objects[1].goals == [[0, 0]]


def test_random_distribution_is_a_placement() -> None:
    robots = [DIFF, {**DIFF, "number": 3, "distribution": {"name": "random"}}]
    obstacle = {"number": 2, "distribution": {"name": "random", "range_low": [0, 3, 0], "min_distance": 0.2}}
    scenario = resolved({"world": WIDE, "robot": robots, "obstacle": obstacle})
    first, second = scenario.placements
    assert (first.objects, first.path, first.min_distance) == ([1, 2, 3], ("robot", 1), 1.0)
    assert (first.range_low, first.range_high) == ([-9.5, 2.5, -math.pi], [9.5, 9.5, math.pi])
    assert (second.objects, second.range_low, second.min_distance) == ([4, 5], [0, 3, 0], 0.2)
    assert scenario.objects[1].goals == []


def test_wander_box_is_the_world_unless_given() -> None:
    data: dict[str, Any] = {
        "world": {"width": 30, "height": 20, "offset": [-5, 5]},
        "robot": {**DIFF, "behavior": {"name": "dash", "wander": True}},
    }
    record = resolved(data).objects[0]
    assert (record.wander, record.range_low, record.range_high) == (True, [-5, 5, -math.pi], [25, 25, math.pi])
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
        ("obstacle", ACKER, "k"),
        ("obstacle", {"mass": 2}, "#E69F00"),
        ("obstacle", {"mass": 2, "static": True}, "k"),
        ("obstacle", {"mass": math.inf}, "k"),
        ("obstacle", {"color": [0.5, 0.5, 1]}, (0.5, 0.5, 1)),
    ],
)
def test_default_colors(role: str, keys: dict[str, Any], color: Any) -> None:
    record = resolved({role: keys}).objects[0]
    assert record.color == color
    assert role == "robot" or record.description is None


def test_cycle_starts_anew_with_every_entry() -> None:
    entry = {**DIFF, "number": 10, "color": "cycle", "distribution": {"name": "random"}}
    colors = [o.color for o in resolved({"robot": [entry, entry]}).objects]
    assert colors == [*CYCLE, *CYCLE[:2]] * 2
    listed = {**entry, "number": 3, "color": ["cycle", "r"]}
    assert [o.color for o in resolved({"robot": listed}).objects] == [CYCLE[0], "r", "r"]


def test_sensors_for_all_or_each() -> None:
    lidar = {"name": "lidar2d", "number": 5}
    for sensors, counts in (([lidar, lidar], [2, 2, 2]), ([[lidar], []], [1, 0, 0])):
        scenario = resolved({"robot": {"number": 3, "state": [[1, 1], [2, 2], [3, 3]], "sensors": sensors}})
        assert [len(o.sensors) for o in scenario.objects] == counts


def test_world_values_are_defaults_of_objects() -> None:
    scenario = resolved({"world": {"friction": 0.2, "restitution": 0.7}, "obstacle": [{}, {"friction": 0.9}]})
    assert [(o.friction, o.restitution) for o in scenario.objects] == [(0.2, 0.7), (0.9, 0.7)]


def test_name_of_the_world() -> None:
    assert resolved({}).name == "world"
    assert resolved({"world": {"name": "yard"}}).name == "yard"
    named = read("world: {height: 3}\n", name="/some/where/yard.v2.yaml").scenario
    assert named is not None
    assert named.name == "yard"


def test_document_is_kept_as_written() -> None:
    text = "world: {height: 3, unknown: 1}\ncustom: {a: [1]}\n"
    scenario = read(text).scenario
    assert scenario is not None
    assert scenario.document == {"world": {"height": 3, "unknown": 1}, "custom": {"a": [1]}}
    assert (scenario.custom, scenario.text) == ({"a": [1]}, text)


@pytest.mark.parametrize(
    ("key", "values"), [("goals", [[[1, 2], [3, 4]], [[5, 6]]]), ("tags", [("a",), ("b", "c")])], ids=str
)
def test_each_object_has_its_own_waypoints_and_tags(key: str, values: list[Any]) -> None:
    given = {"waypoints" if key == "goals" else key: [list(value) for value in values]}
    scenario = resolved({"robot": {"number": 2, "state": [[1, 1], [2, 2]], **given}})
    assert [getattr(o, key) for o in scenario.objects] == values


def test_nothing_is_shared_that_changes() -> None:
    scenario = resolved({"robot": {**DIFF, "number": 2, "vel_max": [2, 2], "distribution": {"name": "circle"}}})
    first, second = scenario.objects
    before = copy.deepcopy(second)
    first.vel_max[0] = first.state[0] = first.goals[0][0] = 9
    assert second == before


numbers = st.floats(allow_nan=False) | st.integers() | st.booleans()
vectors = st.lists(numbers, max_size=4)
others = st.text(max_size=3) | st.none() | vectors | st.dictionaries(st.text(max_size=3), numbers, max_size=2)


@pytest.mark.parametrize(
    ("value", "count", "expected"),
    [
        (0.3, 3, [0.3, 0.3, 0.3]),
        ("r", 2, ["r", "r"]),
        (None, 2, [None, None]),
        ({"name": "diff"}, 2, [{"name": "diff"}] * 2),
        ([1, 2], 3, [[1, 2]] * 3),
        ([True, False], 2, [[True, False]] * 2),
        ([], 2, [[], []]),
        ([[1, 2], [3, 4]], 2, [[1, 2], [3, 4]]),
        ([[1, 2], [3, 4]], 4, [[1, 2], [3, 4], [3, 4], [3, 4]]),
        ([[1, 2], [3, 4], [5, 6]], 2, [[1, 2], [3, 4]]),
        (["r", "b"], 3, ["r", "b", "b"]),
        ([1, "a"], 2, [1, "a"]),
        ([{"name": "a"}], 2, [{"name": "a"}] * 2),
        ([[[1, 1], [2, 2]]], 2, [[[1, 1], [2, 2]]] * 2),
        ([[[1, 1], [2, 2]], [3, 3]], 2, [[[1, 1], [2, 2]], [3, 3]]),
        ([1, 2], 0, []),
        (["a"], 0, []),
    ],
)
def test_the_rule(value: Any, count: int, expected: list[Any]) -> None:
    assert spread(value, count) == expected


def test_exceptions() -> None:
    sensor, other = {"name": "lidar2d"}, {"name": "contact2d"}
    assert kind_of("vel_max") == kind_of("color") == "value"
    assert spread([sensor, other], 2, kind_of("sensors")) == [[sensor, other]] * 2
    assert spread([[sensor], [other]], 3, kind_of("sensors")) == [[sensor], [other], [other]]
    assert spread([1.0, 2.0], 3, kind_of("mass")) == [1.0, 2.0, 2.0]
    assert spread(["a", "b"], 2, kind_of("tags")) == [["a", "b"]] * 2
    assert spread([[1, 1], [2, 2]], 2, kind_of("waypoints")) == [[[1, 1], [2, 2]]] * 2
    assert spread([[[1, 1], [2, 2]], [[3, 3]]], 2, kind_of("waypoints")) == [[[1, 1], [2, 2]], [[3, 3]]]


@given(others | st.lists(others, max_size=6), st.integers(0, 5))
def test_what_more_objects_get_does_not_change_the_first(values: Any, count: int) -> None:
    before = repr(values)
    assert spread(values, count + 3)[:count] == spread(values, count)
    assert repr(values) == before


@given(
    st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)).map(list), min_size=1, max_size=5),
    st.lists(st.sampled_from("rgbk"), min_size=1, max_size=5),
    st.integers(1, 6),
)
def test_objects_get_what_the_rule_says(states: list[list[int]], colors: list[str], count: int) -> None:
    reading = read({"obstacle": {"number": count, "state": states, "color": colors, "shape": [{"name": "circle"}]}})
    assert reading.scenario is not None
    expected = zip(spread(states, count), spread(colors, count), strict=True)
    rows = [(record.state[:2], record.color) for record in reading.scenario.objects]
    assert rows == [([float(x), float(y)], color) for (x, y), color in expected]
