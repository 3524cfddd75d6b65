"""Checks of valid scenarios: each finds what it should, and sane files give nothing."""

from __future__ import annotations

import json
import math
from typing import Any

import pytest

import irsim
from irsim.diagnostics.diagnostic import format_path
from irsim.options import registry
from irsim.scenario.read import read

DIFF = {"kinematics": {"name": "diff"}, "shape": {"name": "circle"}, "behavior": {"name": "dash"}, "goal": [9, 9]}


def findings(data: Any, *, strict: bool = True) -> list[str]:
    """Each as "severity code path"; states left out are not told of."""
    rows = [f"{d.severity} {d.code} {format_path(d.path)}" for d in read(data, strict=strict).diagnostics]
    return [row for row in rows if not row.startswith("hint default-state")]


def robot(**keys: Any) -> dict[str, Any]:
    entry = {**DIFF, **keys}
    if "waypoints" in keys or ("distribution" in keys and "goal" not in keys):
        del entry["goal"]
    return {"robot": [entry]}


def obstacle(**keys: Any) -> dict[str, Any]:
    return {"obstacle": [{"shape": {"name": "circle"}, **keys}]}


def crossing(name: str = "circle_crossing", number: int = 5, **keys: Any) -> dict[str, Any]:
    return robot(number=number, **SMALL, distribution={"name": name, **keys})


def turned(drive: str, goal: list[float], behavior: str = "orca") -> dict[str, Any]:
    """A robot whose goal has a heading."""
    kinematics = {"name": drive, **({"wheelbase": 1} if drive == "acker" else {})}
    return robot(kinematics=kinematics, goal=goal, arrive_mode="state", behavior={"name": behavior}, state=[1, 1, 0])


SMALL = {"shape": {"name": "circle", "radius": 0.3}}
DISCS = {"distribution": {"name": "random"}, "shape": {"name": "circle", "radius": 0.8}}
CAR = {"kinematics": {"name": "acker", "wheelbase": 1}, "vel_min": [-1, -0.5]}
SHIP = robot(shape={"name": "rectangle", "length": 220, "width": 30}, state=[200, 150], goal=[900, 150])
CLOSE = {"robot": [{**DIFF, "state": [1, 1]}, {**DIFF, "state": [1.1, 1], "goal": [9, 5]}]}
PARKED = {"shape": {"name": "circle", "radius": 0.5}, "number": 3, "state": [[2, 2, 0], [2.5, 2, 0], [3.2, 2, 0]]}
MOVING = {**DIFF, "state": [5, 5]}
GROUPED = {**DIFF, "number": 2, "distribution": {"name": "circle"}, "group_behavior": {"name": "orca"}}
TRIANGLES = [{"name": "polygon", "vertices": [[i, 5], [i + 1, 5], [i, 6]]} for i in range(3)]
BOX = {"name": "rectangle", "length": 2, "width": 0.3}

SANE: list[dict[str, Any]] = [
    {},
    {"world": {}},
    robot(),
    robot(state=[2, 3]),
    robot(goal=[[[2, 2], [5, 5]]]),
    robot(waypoints=[[2, 2], [5, 5]]),
    robot(vel_max=[1, 1]),
    robot(behavior={"name": "rvo", "vxmax": 1.5, "vymax": 1.5}),
    robot(behavior={"name": "orca", "maxSpeed": 2}, vel_max=[2, 1], vel_min=[-2, -1]),
    robot(kinematics={"name": "acker", "wheelbase": 2.6}, state=[5, 5, 1.57], goal=[5, 6.2]),
    robot(sensors=[{"number": 9, "range_max": 300, "offset": [0.5, 0, 0]}]),
    {"obstacle": [{"shape": {"name": "circle"}, "state": [5, 2]}, {"shape": {"name": "rectangle"}, "state": [5, 2]}]},
    {"world": {"collision_mode": "unobstructed"}, **robot(number=6, distribution={"name": "circle", "radius": 5})},
    robot(vel_max=[0.5, 3], vel_min=[-0.5, -3]),
    robot(vel_max=[0.5, 0.5]),
    robot(acce=[math.inf, 2]),
    robot(kinematics={"name": "acker", "wheelbase": 1}),
    robot(kinematics={"name": "acker"}, shape={"name": "rectangle", "wheelbase": 1}),
    robot(kinematics={"name": "diff", "noise": True}),
    robot(kinematics={"name": "omni"}),
    robot(behavior={"name": "dash", "wander": True}),
    {"obstacle": [{"number": 2, "shape": BOX, "state": [[5, 8, 0], [5, 8, 1.5708]]}]},
    robot(behavior={"name": "follow", "local": {"name": "orca", "timeHorizon": 2}}),
    robot(behavior={"name": "follow", "local": {"name": "orca", "target_roles": "all"}}),
    {"world": {"width": 6, "height": 6, "offset": [20, 20]},
        **robot(state=[21, 21, 0], behavior={"name": "dash", "wander": True}, goal=None)},
    robot(behavior={"name": "dash", "wander": True, "range_low": [1, 1, 0], "range_high": [9, 9, 0]}),
    robot(number=8, distribution={"name": "circle"}),
    robot(number=8, distribution={"name": "random"}),
    robot(fov=1.5, fov_radius=4),
    robot(sensors=[{"name": "lidar2d", "angle_range": 6.2832}], fov=6.28),
    robot(sensors=[{"number": 361, "angle_range": 6.2832}, {"number": 360, "angle_range": 6.26573}]),
    robot(sensors=[{"number": 1, "angle_range": 0}, {"number": 1}, {"name": "fmcw_lidar2d", "velocity_noise_std": 1}]),
    {"world": {"fog_map": True}, **robot(sensors=[{"number": 9}])},
    {"world": {"fog_map": True}, **robot(fov=1, fov_radius=2)},
    robot(color=["r"], name=["walle"]),
    robot(angle_range=[-3.141592653589793, 3.141592653589793]),
    robot(angle_range=[0, 6.2831853]),
    robot(static=True, behavior=None),
    {"robot": [{**DIFF, "state": [1, 1]}, {**DIFF, "state": [3, 1]}]},
    {"world": {"sample_time": 0.3}},
    {"world": {"sample_time": 0.30000000000000004, "step_time": 0.1}},
    {"world": {"plot": {"viewpoint": "walle"}}, **robot(name="walle")},
    obstacle(),
    obstacle(state=[20, 20]),
    obstacle(number=3, state=[0, 0, 0], shape=TRIANGLES),
    obstacle(shape={"name": "polygon", "vertices": [[0, 0], [2, 0], [2, 2], [1, 0.5], [0, 2]]}, state=[4, 4, 0]),
    obstacle(shape={"name": "polygon", "vertices": [[0, 0], [2, 0], [0, 2], [0, 0]]}, state=[4, 4, 0]),
    obstacle(shape={"name": "polygon", "vertices": [[0, 0], [1, 0], [2, 0], [2, 2]]}, state=[4, 4, 0]),
    obstacle(shape={"name": "linestring", "random_shape": True}),
    obstacle(shape={"name": "polygon", "random_shape": True, "center_range": [1, 1, 8, 8]}, number=4),
    {"robot": {**DIFF}, "obstacle": {"shape": {"name": "rectangle"}, "state": [5, 5, 0]}},
    robot(number=5, **DISCS),
    robot(distribution={"name": "random", "min_distance": 30.0}),
    *(crossing(number=number, radius=4) for number in (5, 15)),
    *(crossing("square_crossing", number=number, width=5) for number in (10, 30)),
    robot(**CAR, vel_max=[1, 0.5]),
    *(turned(drive, [9, 9, 1]) for drive in ("diff", "omni_angular")),
    turned("acker", [9, 9, 1], "follow"),
    *(turned("omni", goal) for goal in ([9, 9, 0], [9, 9])),
    robot(description="car_red.png"),
    {"obstacle": [PARKED]},
    robot(goal=[9.7, 4], **SMALL),
    {**robot(goal=[9.9, 4], **SMALL), "world": {"boundary": "walls"}},  # another finding says that it does not fit
    {"robot": GROUPED, "obstacle": [MOVING]},
    *(robot(behavior={"name": "rvo", **keys}) for keys in ({}, {"acce": 1.0})),
]  # fmt: skip


@pytest.mark.parametrize("data", SANE, ids=lambda data: str(data)[:60])
def test_sane_scenarios_give_nothing(data: dict[str, Any]) -> None:
    stacked_random = "center_range" in str(data)
    rows = findings(data)
    assert [row for row in rows if not (stacked_random and " stacked " in row)] == []


CASES: list[tuple[dict[str, Any], str]] = [
    (robot(goal=[[2, 1], [5, 1], [5, 5]]), "warning goal-levels robot[0].goal"),
    (robot(number=2, state=[[1, 1], [3, 3]], goal=[[2, 1], [5, 1], [5, 5]]), "warning goal-levels robot[0].goal"),
    (robot(sensors=[{"number": 360, "angle_range": 6.28}]), "hint lidar-ends-meet robot[0].sensors[0].number"),
    (robot(sensors=[{"number": 360, "angle_range": 6.3}]), "hint lidar-ends-meet robot[0].sensors[0].number"),
    (robot(sensors=[{"number": 1, "angle_range": 3.0}]), "hint lidar-beams robot[0].sensors[0].angle_range"),
    (robot(sensors=[{"number": 5, "angle_range": 0}]), "hint lidar-beams robot[0].sensors[0].angle_range"),
    (robot(sensors=[{"number": 5, "std": 0.1}]), "hint lidar-noise-off robot[0].sensors[0].std"),
    (robot(sensors=[{"name": "fmcw_lidar2d", "has_velocity": True}]),
        "hint ignored-key robot[0].sensors[0].has_velocity"),
    (robot(sensors=[{"name": "cliff"}]), "hint cliff-without-zones robot[0].sensors[0]"),
    (robot(sensors=[{"name": "sonar", "range_min": 5.0}]), "error range-order robot[0].sensors[0].range_min"),
    (robot(sensors=[{"name": "gnss", "blocked": ["hall"]}]), "error unknown-zone robot[0].sensors[0].blocked[0]"),
    ({"world": {"fog_map": True}, **robot()}, "hint fog-never-lifts world.fog_map"),
    ({"world": {"fog_map_resolution": 0.2}, **robot()}, "hint ignored-key world.fog_map_resolution"),
    ({"world": {"fog_map": True, "fog_map_resolution": 1e-4}, **robot(sensors=[{"number": 5}])},
        "error fog-too-fine world.fog_map_resolution"),
    (robot(state=[1, 1, 0, 0]), "hint state-truncated robot[0].state"),
    (robot(vel_max=[1.5, 1]), "hint vel-min-default robot[0].vel_max"),
    (robot(number=3, state=[5, 5]), "warning stacked robot[0].state"),
    (robot(number=3), "warning stacked robot[0].number"),
    (robot(kinematics={"name": "acker"}), "hint wheelbase-default robot[0].kinematics.name"),
    (robot(kinematics={"name": "omni", "noise": True}), "hint omni-noise robot[0].kinematics.noise"),
    (robot(kinematics=None), "warning behavior-without-kinematics robot[0].behavior"),
    (robot(behavior=None), "hint no-behavior robot[0]"),
    (robot(shape=None), "hint default-shape robot[0]"),
    (robot(goal=None), "hint default-goal robot[0]"),
    (robot(state=[1, 1, 90]), "hint heading-in-degrees robot[0].state"),
    (robot(goal=[[[2, 2, 0], [3, 3, -180]]]), "hint heading-in-degrees robot[0].goal[0][1]"),
    (robot(waypoints=[[2, 2, 0], [3, 3, 90]]), "hint heading-in-degrees robot[0].waypoints[1]"),
    (robot(state=[20, 1]), "hint outside-world robot[0].state"),
    (robot(number=6, distribution={"name": "circle", "radius": 8}), "hint outside-world robot[0].distribution"),
    (robot(number=3, distribution={"name": "random", "range_low": [1, 1, 0], "range_high": [20, 20, 1]}),
        "hint outside-world robot[0].distribution.range_high"),
    ({"world": {"offset": [-5, -5]}, **robot(number=4, distribution={"name": "circle", "center": [5, 5]})},
        "hint outside-world robot[0].distribution"),
    (robot(state=[[1, 1], [3, 3]], goal=[[9, 1], [9, 3]]), "warning surplus-states robot[0].state"),
    (robot(number=2, state=[[1, 1], [3, 3], [5, 5]], goal=[[2, 2], [4, 4], [6, 6]]),
        "hint surplus-states robot[0].state"),
    (obstacle(shape={"name": "circle", "radius": 50}, state=[5, 5]), "hint looks-like-centimetres obstacle[0].shape"),
    (obstacle(state=[500, 300]), "hint looks-like-centimetres obstacle[0].state"),
    (robot(sensors=[{"range_min": 3, "range_max": 3}]), "error range-order robot[0].sensors[0].range_min"),
    (robot(sensors=[{"range_max": 5000}]), "hint looks-like-centimetres robot[0].sensors[0].range_max"),
    (robot(sensors=[{"offset": [20, 0, 0]}]), "hint looks-like-centimetres robot[0].sensors[0].offset"),
    (robot(behavior={"name": "sfm", "vmax": 5}), "hint speed-capped robot[0].behavior.vmax"),
    (robot(behavior={"name": "rvo", "vxmax": 3, "vymax": 3}), "hint speed-capped robot[0].behavior.vxmax"),
    (robot(behavior={"name": "orca", "maxSpeed": 3}), "hint speed-capped robot[0].behavior.maxSpeed"),
    (robot(behavior={"name": "avocado", "maxSpeed": 3}), "hint speed-capped robot[0].behavior.maxSpeed"),
    (robot(kinematics={"name": "acker"}, shape={"name": "rectangle", "wheelbase": 2.6}),
        "hint wheelbase-over-length robot[0].shape"),
    (robot(kinematics={"name": "acker", "wheelbase": 2.6}, state=[5, 5, 0], goal=[5, 6.2]),
        "warning turning-circle robot[0].state"),
    ({"obstacle": 2 * [{"shape": {"name": "circle"}, "state": [5, 2]}]}, "hint stacked obstacle[1].state"),
    (robot(goal=[20, 1]), "hint outside-world robot[0].goal"),
    (robot(waypoints=[[2, 2], [20, 1]]), "hint outside-world robot[0].waypoints[1]"),
    (robot(behavior={"name": "dash", "wander": True, "range_low": [0, 0, 0], "range_high": [20, 5, 0]}),
        "hint wander-outside robot[0].behavior.range_high"),
    (robot(behavior={"name": "dash", "wander": True, "range_low": [-2, 0], "range_high": [5, 5]}),
        "hint wander-outside robot[0].behavior.range_low"),
    ({"obstacle": [{"number": 2, "shape": BOX, "state": [[5, 8, 0], [5, 8, 0]]}]}, "warning stacked obstacle[0].state"),
    ({"obstacle": [{"number": 2, "shape": {"name": "circle"}, "state": [[5, 8, 0], [5, 8, 1]]}]},
        "warning stacked obstacle[0].state"),
    (robot(behavior={"name": "dash", "wander": True, "range_low": [5, 5], "range_high": [1, 9]}),
        "error range-order robot[0].behavior.range_low"),
    (robot(behavior={"name": "dash", "wander": True, "loop": True}), "warning wander-and-loop robot[0].behavior.loop"),
    (robot(number=40, distribution={"name": "circle", "radius": 1}), "warning circle-overlap robot[0].distribution"),
    (robot(distribution={"name": "random"}, goal=[5, 5]), "warning ignored-key robot[0].goal"),
    (robot(distribution={"name": "circle"}, state=[5, 5]), "warning ignored-key robot[0].state"),
    (robot(behavior={"name": "follow", "local": {"name": "orca", "loop": True}}),
        "warning ignored-key robot[0].behavior.local.loop"),
    (robot(fov_radius=3), "hint fov-radius-ignored robot[0].fov_radius"),
    (robot(fov=1.0), "hint fov-without-radius robot[0].fov"),
    (robot(velocity=[1]), "error wrong-length robot[0].velocity"),
    (robot(number=2, state=[[1, 1], [2, 2]], vel_max=[[1, 1], [1]]), "error wrong-length robot[0].vel_max[1]"),
    (robot(vel_max=[-2, 1]), "error limits-order robot[0].vel_max"),
    (obstacle(shape={"name": "polygon"}, state=[5, 5, 0]), "hint default-vertices obstacle[0].shape"),
    (obstacle(shape={"name": "polygon", "vertices": [[0, 0], [1, 0], [0, 1]]}),
        "warning default-state obstacle[0].shape"),
    (obstacle(shape={"name": "polygon", "random_shape": True, "num_vertices_range": [4, 4]}),
        "error range-order obstacle[0].shape.num_vertices_range"),
    (obstacle(shape={"name": "compound", "parts": [{"name": "polygon", "vertices": [[0, 0], [1, 1]]}]}),
        "error too-few-vertices obstacle[0].shape.parts[0].vertices"),
    ({**robot(state=[5, 5]), "obstacle": [{"shape": {"name": "circle", "radius": 1}, "state": [5.5, 5]}]},
        "warning initial-overlap robot[0].state"),
    ({"world": {"sample_time": 0.05}}, "hint sample-time world.sample_time"),
    ({"world": {"sample_time": 0.25}}, "hint sample-time world.sample_time"),
    ({"world": {"time_limit": 0.01}}, "warning time-limit world.time_limit"),
    # 1.6 m apart in 9 m x 9 m: at most 48 by Groemer's bound; discs dropped at random jam at half the ground.
    (robot(number=30, **DISCS), "warning placement-tight robot[0].distribution"),
    (robot(number=48, **DISCS), "warning placement-tight robot[0].distribution"),
    (robot(number=60, **DISCS), "error placement-crowded robot[0].distribution"),
    (robot(number=40, distribution={"name": "random", "min_distance": 3.0}),
        "error placement-crowded robot[0].distribution"),
    (crossing(number=20, radius=4), "warning placement-tight robot[0].distribution"),
    (crossing(number=60, radius=4), "error placement-crowded robot[0].distribution"),
    (crossing("square_crossing", number=40, width=5), "warning placement-tight robot[0].distribution"),
    (crossing("square_crossing", number=120, width=5), "error placement-crowded robot[0].distribution"),
    (crossing(radius=5), "hint outside-world robot[0].distribution"),
    (robot(**SMALL, distribution={"name": "circle_crossing", "radius": 3}, goal=[1, 1]),
        "warning ignored-key robot[0].goal"),
    (crossing("square_crossing", width=11), "hint outside-world robot[0].distribution"),
    (robot(**CAR, vel_max=[1, 30]), "warning steering-limit robot[0].vel_max"),
    (turned("omni", [9, 9, 1]), "warning heading-not-reached robot[0].arrive_mode"),
    (turned("acker", [9, 9, 1]), "warning heading-not-reached robot[0].arrive_mode"),
    ({"world": {"width": 1e8}}, "error too-large world.width"),
    (robot(description="file:///x.png"), "warning image-not-found robot[0].description"),
    (robot(goal=[9.9, 4], **SMALL), "hint outside-world robot[0].goal"),
    ({"world": {"collision_mode": "stop"}, **CLOSE}, "warning initial-overlap robot[0].state"),
    ({"world": {"collision_mode": "unobstructed"}, **CLOSE}, "hint initial-overlap robot[0].state"),
    ({"world": {"width": 2000, "height": 2000}, **SHIP}, "hint looks-like-centimetres robot[0].shape"),
    ({"world": {"width": 2000, "height": 300}, **SHIP}, "warning looks-like-centimetres robot[0].shape"),
    (robot(behavior={"name": "rvo", "acce": 3.0}), "hint rvo-acce robot[0].behavior.acce"),
    # A single mapping of obstacles joins the group of the first robots; only the first member's group behavior counts.
    ({"robot": GROUPED, "obstacle": MOVING}, "warning group-drives-obstacle obstacle"),
    ({"robot": [{**DIFF, "group": 1}, {**DIFF, "group": 1, "state": [3, 3], "group_behavior": {"name": "sfm"}}]},
        "hint group-behavior-unused robot[1].group_behavior"),
    # One finding for an entry, however many objects it has.
    (robot(number=50, distribution={"name": "random"}, vel_max=[1, 1, 1]), "error wrong-length robot[0].vel_max"),
]  # fmt: skip


@pytest.mark.parametrize(("data", "finding"), CASES, ids=[f"{case[1].split()[1]}-{i}" for i, case in enumerate(CASES)])
def test_finds(data: dict[str, Any], finding: str) -> None:
    assert findings(data) == [finding]


def test_an_empty_description_is_a_plain_car() -> None:
    assert findings(robot(**CAR, description="")) == findings(robot(**CAR))


@pytest.mark.parametrize("strict", [True, False])
def test_what_is_not_simulated_yet_is_said(strict: bool) -> None:
    data = robot(shape={"name": "compound", "parts": [{"name": "polygon", "random_shape": True, "pose": [1, 0, 0]}]})
    assert findings(data, strict=strict) == ["error not-yet-simulated robot[0].shape.parts[0].pose"]
    assert read(data, strict=strict).scenario is None


@pytest.mark.parametrize(
    ("keys", "fix"),
    [
        ({}, "add 'kinematics: {name: diff}' (or omni, omni_angular, acker)"),
        ({"kinematics": {"name": "static"}},
            "write 'kinematics: {name: diff}' (or omni, omni_angular, acker) instead of {name: static}"),
        ({"kinematics": None}, "write 'kinematics: {name: diff}' (or omni, omni_angular, acker) instead of null"),
    ],
)  # fmt: skip
def test_what_makes_it_move_is_no_second_key(keys: dict[str, Any], fix: str) -> None:
    entry = {"shape": {"name": "circle"}, "state": [5, 8, 0], "goal": [5, 2], "behavior": {"name": "dash"}, **keys}
    diagnostics = read({"obstacle": [entry]}, strict=True).diagnostics
    assert [item.fix for item in diagnostics if item.code == "behavior-without-kinematics"] == [fix]


def test_who_is_driven_by_a_group_does_not_stand_still() -> None:
    """The behavior of the first member drives the others, obstacles too; without one in the group they stand."""
    still = {key: value for key, value in DIFF.items() if key != "behavior"}
    leader = {**still, "group": 0, "group_behavior": {"name": "orca"}, "state": [1, 5, 0], "goal": [9, 5]}
    member = {**still, "state": [1, 7, 0], "goal": [9, 7]}
    for others in ({"robot": [leader, {**member, "group": 0}]}, {"robot": [leader], "obstacle": member}):
        assert "no-behavior" not in str(findings(others))
    scenario = "world: {}\nrobot: " + json.dumps([leader, {**member, "group": 0}])
    assert irsim.run(text=scenario, seed=0).outcome == "success"
    assert findings({"robot": [leader, {**member, "group": 1}]}) == ["hint no-behavior robot[1]"]


def test_behaviors_of_user_code(monkeypatch: pytest.MonkeyPatch) -> None:
    data = robot(behavior={"name": "zigzag", "width": 2}, state=[1, 1, 0])
    assert findings(data) == ["error unknown-behavior robot[0].behavior.name"]
    assert findings(data, strict=False) == ["warning unknown-behavior robot[0].behavior.name"]
    lenient = read(data).scenario
    assert lenient is not None
    assert getattr(lenient.objects[0].behavior, "width", None) == 2

    functions: dict[tuple[str, str], Any] = {("omni", "zigzag"): print}
    monkeypatch.setattr(registry.CUSTOM_BEHAVIORS, "functions", functions)
    assert findings(data) == ["error behavior-for-other-drive robot[0].behavior.name"]
    (item,) = read(data, strict=True).diagnostics
    assert "omni" in item.message
    functions["diff", "zigzag"] = print
    assert findings(data) == []
    known = read(robot(behavior={"name": "zigzga"}), strict=True).diagnostics[0]
    assert known.fix == "name: zigzag"


def test_custom_behaviors_keep_their_names_apart() -> None:
    table = registry.CustomBehaviors("behavior", functions_taken=[("diff", "dash")])
    table.register("diff", "zigzag", print)
    table.register("diff", "zigzag", print)
    table.register("omni", "zigzag", len)
    with pytest.raises(ValueError, match="already registered"):
        table.register("diff", "zigzag", len)
    with pytest.raises(ValueError, match="built-in"):
        table.register("diff", "dash", len)
    assert table.function("diff", "zigzag") is print
    assert table.function("acker", "zigzag") is None
    assert table.names() == table.names("diff") == ["zigzag"]
    assert table.drives("zigzag") == ["diff", "omni"]


def test_invalid_polygons_are_repaired_when_lenient() -> None:
    def repaired(*vertices: list[float]) -> Any:
        scenario = read(obstacle(shape={"name": "polygon", "vertices": [*vertices]}, state=[4, 4, 0])).scenario
        assert scenario is not None
        return scenario.objects[0].shape

    bowtie = repaired([0, 0], [2, 2], [2, 0], [0, 2])
    assert (bowtie.name, len(bowtie.parts)) == ("compound", 2)
    spike = repaired([0, 0], [2, 0], [2, 2], [3, 3], [2, 2], [0, 2])
    assert spike.name == "polygon"
    assert sorted(map(tuple, spike.vertices)) == [(0, 0), (0, 2), (2, 0), (2, 2)]
