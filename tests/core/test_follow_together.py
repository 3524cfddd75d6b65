"""Several objects under follow: through doors and mazes without a touch, and round others that stand for good."""

from __future__ import annotations

import itertools
import json
import math
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.api.read_input import read_scenario
from irsim.navigation.clearances import clearance
from irsim.simulation.simulation import Simulation
from tests.core.worlds import assert_success, collisions

DRIVES: dict[str, tuple[str, str, list[float], float]] = {
    "omni": ("{name: omni}", "{name: circle, radius: 0.25}", [0.8, 0.8], 0.2),
    "omni_angular": ("{name: omni_angular}", "{name: circle, radius: 0.25}", [0.8, 0.8, 1.5], 0.2),
    "diff": ("{name: diff}", "{name: circle, radius: 0.25}", [0.8, 1.5], 0.2),
    "acker": ("{name: acker}", "{name: rectangle, length: 0.8, width: 0.5, wheelbase: 0.5}", [0.8, 0.6], 0.35),
}
UP, WEST = math.pi / 2, 3.14159
LONG = [(9.5, 0.2, x, y, 0) for x, y in ((4.75, 2.4), (7.25, 4.8), (4.75, 7.2), (7.25, 9.6))]
# name -> (width, height, time limit), starts, goals, walls: length, width, x, y, heading
SCENES: dict[str, tuple[tuple[float, ...], list[Any], list[Any], list[tuple[float, ...]]]] = {
    "door of 0.9 m": (
        (12.2, 8, 60), [[1.5, 2, 0], [1.5, 4, 0], [1.5, 6, 0]], [[10.7, 2], [10.7, 4], [10.7, 6]],
        [(3.55, 0.2, 6.1, 1.775, UP), (3.55, 0.2, 6.1, 6.225, UP)],
    ),
    "doorway, both ways": (
        (12, 8, 90), [[2, 2, 0], [2, 6, 0], [11, 1.2, WEST], [11, 6.8, WEST]], [[10, 2], [10, 6], [2, 4.5], [2, 3.5]],
        [(3.2, 0.2, 6, 1.6, UP), (3.2, 0.2, 6, 6.4, UP)],
    ),
    "corridor, both ways": (
        (14, 5, 60), [[1, 2.5, 0], [13, 2.5, WEST]], [[13, 2.5], [1, 2.5]],
        [(10, 0.3, 7, 3.45, 0), (10, 0.3, 7, 1.55, 0)],
    ),
    "maze, both ways": (
        (12, 12, 180), [[1, 1, 0], [2.2, 1.2, 0], [3.4, 1, 0], [11, 11, WEST]],
        [[6.5, 11], [8.7, 11.2], [11, 10.6], [1, 1]], [*LONG, (3, 0.2, 6, 6.2, 0)],
    ),
    "exit of a room": (
        (14, 8, 120), [[1.2 + 1.3 * i, 2.2 + 1.8 * j, 0] for i in range(3) for j in range(3)],
        [[12.5, 1 + 0.75 * k] for k in range(9)], [(3.4, 0.2, 6, 1.7, UP), (3.4, 0.2, 6, 6.3, UP)],
    ),
}  # fmt: skip


def text_of(name: str, drive: str) -> str:
    (width, height, limit), starts, goals, walls = SCENES[name]
    kinematics, shape, top, threshold = DRIVES[drive]
    boxes = "".join(
        f"  - {{shape: {{name: rectangle, length: {length}, width: {thick}}}, state: [{x}, {y}, {theta}]}}\n"
        for length, thick, x, y, theta in walls
    )
    return (
        f"world: {{width: {width}, height: {height}, time_limit: {limit}, boundary: walls}}\nrobot:\n"
        f"  - number: {len(starts)}\n    kinematics: {kinematics}\n    shape: {shape}\n"
        f"    state: {json.dumps(starts)}\n    goal: {json.dumps(goals)}\n    goal_threshold: {threshold}\n"
        f"    vel_max: {top}\n    vel_min: {[-v for v in top]}\n"
        f"    behavior: {{name: follow, local: {{name: orca, timeHorizon: 2, timeHorizonObst: 1}}}}\nobstacle:\n{boxes}"
    )


@pytest.mark.parametrize(
    ("name", "drive"),
    [
        ("door of 0.9 m", "omni"),
        ("door of 0.9 m", "diff"),
        ("door of 0.9 m", "acker"),  # they block each other, back up, and go one by one
        ("corridor, both ways", "acker"),  # their bounding circles do not fit beside each other, their bodies do
    ],
)
def test_robots_do_not_jam(name: str, drive: str) -> None:
    assert_success(text_of(name, drive), seed=0)


@pytest.mark.parametrize("drive", ["omni", "acker"])
def test_who_goes_first_does_not_depend_on_the_order_of_robots(drive: str) -> None:
    text = text_of("door of 0.9 m", drive).replace("[1.5, 2, 0]", "[1.4, 2, 0]")
    other = text.replace("[[1.4, 2, 0], [1.5, 4, 0], [1.5, 6, 0]]", "[[1.5, 6, 0], [1.4, 2, 0], [1.5, 4, 0]]")
    other = other.replace("[[10.7, 2], [10.7, 4], [10.7, 6]]", "[[10.7, 6], [10.7, 2], [10.7, 4]]")
    times = [[robot.time_to_goal for robot in irsim.run(text=t, seed=0).robots] for t in (text, other)]
    assert None not in times[0]
    assert times[1] == [times[0][2], times[0][0], times[0][1]]


@pytest.mark.parametrize(("drive", "least"), [("omni", 0.03), ("diff", 0.03), ("acker", 0.009)])
def test_robots_that_are_pushed_aside_keep_a_margin_to_walls(drive: str, least: float) -> None:
    scenario, _ = read_scenario(text=text_of("door of 0.9 m", drive), strict=False)
    simulation = Simulation(scenario, [0])
    poses = []
    for _ in range(200):
        simulation.advance(1)
        poses.append(simulation.pose.copy())
    assert np.nanmin(clearance(np.array(poses), simulation).static) > least


@pytest.mark.slow
@pytest.mark.parametrize(("name", "drive"), list(itertools.product(SCENES, DRIVES)))
def test_nobody_jams_from_starts_that_are_a_little_different(name: str, drive: str) -> None:
    arrived: list[bool] = []
    for seed in range(10 if drive == "acker" else 20):
        result = irsim.run(text=text_of(name, drive), seed=seed, perturb={"position": 0.1})
        assert collisions(result) == [], seed
        arrived += [robot.time_to_goal is not None for robot in result.robots]
    assert np.mean(arrived) >= 0.98


@pytest.mark.parametrize("seed", [121, 172, 223, 238, 257, 356])
def test_cars_that_brake_slowly_do_not_touch_the_walls_of_a_crowded_room(seed: int) -> None:
    """A car that is suddenly blocked brakes with the steering with which its stop was free."""
    draw = random.Random(seed)

    def place(*ranges: tuple[float, float]) -> list[float]:
        return [round(draw.uniform(*limits), 2) for limits in ranges]

    local = draw.choice(["rvo", "sfm", "orca", "dash"])
    draw.choice(["acker", "acker", "diff"])
    inside = ((1, 9), (1, 9))
    cars = [
        f"  - {{kinematics: {{name: acker}}, shape: {{name: rectangle, length: 0.8, width: 0.4, wheelbase: 0.5}}, "
        f"vel_max: [1.2, 1], vel_min: [-1.2, -1], acce: [1, 3], state: {place(*inside, (-3, 3))}, "
        f"goal: {[*place(*inside), 0]}, goal_threshold: 0.3, behavior: {{name: follow, local: {{name: {local}}}}}}}"
        for _ in range(4)
    ]
    integration = draw.choice(["euler", "exact"])
    world = f"world: {{width: 10, height: 10, boundary: walls, integration: {integration}}}"
    result = irsim.run(text="\n".join([world, "robot:", *cars]), seed=1, steps=400)
    starts = {event.object for event in result.events if event.kind == "collision" and event.step <= 1}
    hits = [event for event in result.events if event.kind == "collision" and "boundary" in str(event.partner)]
    assert [event for event in hits if event.object not in starts] == []


def boxes(*placed: Sequence[float]) -> list[dict[str, Any]]:
    """Boxes of a length and width [m], at a pose."""
    return [
        {"shape": {"name": "rectangle", "length": length, "width": width}, "state": pose}
        for length, width, *pose in placed
    ]


def run_cars(local: str, world: dict[str, Any], limits: dict[str, Any], ways: list[Any], obstacles: Any) -> Any:
    """Run cars that brake slowly; ways are starts and goals."""
    car = {
        "kinematics": {"name": "acker"},
        "shape": {"name": "rectangle", "length": 0.6, "width": 0.4, "wheelbase": 0.35},
        "goal_threshold": 0.3,
        "behavior": {"name": "follow", "local": {"name": local}},
        **limits,
    }
    cars = [car | {"state": start, "goal": goal} for start, goal in ways]
    world = {"boundary": "walls", "contacts": "swept", **world}
    return irsim.run(text=yaml.safe_dump({"world": world, "robot": cars, "obstacle": obstacles}), seed=1)


SLOW_CARS = yaml.safe_load(Path(__file__).with_name("slow_cars.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", SLOW_CARS, ids=lambda case: f"{case['local']}-{case['world']['step_time']}")
def test_cars_that_brake_slowly_touch_nobody(case: dict[str, Any]) -> None:
    world = {"width": 15, "height": 15, "time_limit": 60} | case["world"]
    ways = [(row[:3], row[3:]) for row in case["robots"]]
    result = run_cars(case["local"], world, case["limits"], ways, boxes(*case["obstacles"]))
    assert collisions(result) == []
    assert 2 * sum(robot.time_to_goal is not None for robot in result.robots) >= len(result.robots)


@pytest.mark.slow
@pytest.mark.parametrize("local", ["orca", "footprint_orca", "rvo", "sfm", "avocado"])
def test_no_car_that_brakes_slowly_touches_anything_in_random_crowds(local: str) -> None:
    """Eight cars among four boxes, with steps of up to 0.3 s."""
    for seed in range(12):
        draw = random.Random(seed)
        taken: list[tuple[list[float], float]] = []

        def place(radius: float, draw: random.Random = draw, taken: list[tuple[list[float], float]] = taken) -> Any:
            while True:
                spot = [draw.uniform(1.2, 10.8), draw.uniform(1.2, 10.8)]
                if all(math.dist(spot, other) > radius + size + 0.25 for other, size in taken):
                    taken.append((spot, radius))
                    return spot

        acce, top = draw.choice([0.3, 0.6, 1]), draw.choice([0.8, 1.5])
        ends = [(place(0.45), place(0.45)) for _ in range(8)]
        ways = [([*start, math.atan2(goal[1] - start[1], goal[0] - start[0])], goal) for start, goal in ends]
        limits = {"vel_max": [top, 0.8], "vel_min": [-top, -0.8], "acce": [acce, 4]}
        blocks = boxes(*([1.2, 0.8, *place(0.75), draw.uniform(-3, 3)] for _ in range(4)))
        world = {"width": 12, "height": 12, "time_limit": 40, "step_time": draw.choice([0.1, 0.2, 0.3])}
        world["integration"] = draw.choice(["euler", "exact"])
        assert collisions(run_cars(local, world, limits, ways, blocks)) == [], seed


def scene(parked: str, behavior: str, doors: str = "two", after: str = "freeze") -> str:
    """Two rooms with doors between them, a robot that comes to stand in the first door, and one that wants through."""
    middle = 4.4 if doors == "two" else 8.2
    return f"""
world: {{width: 20, height: 12, after_arrival: {after}, boundary: walls, time_limit: 90}}
robot:
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.4}}, vel_max: [1, 3], vel_min: [-1, -3], {parked}}}
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, vel_max: [1, 3], vel_min: [-1, -3],
      state: [1, 3, 0], goal: [18, 3], goal_threshold: 0.3, behavior: {behavior}}}
obstacle:
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, 1.1, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: {middle}}}, state: [10, {3.8 + middle / 2}, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, 10.9, 0]}}
"""


ARRIVES = "state: [6, 3, 0], goal: [10, 3], behavior: {name: dash}"
HITS = "state: [10, 2.68, 1.5708], goal: [10, 5], behavior: {name: dash}"
LOCALS = ["orca", "footprint_orca", "dash", "rvo"]


@pytest.mark.parametrize("local", LOCALS)
@pytest.mark.parametrize("parked", [ARRIVES, HITS], ids=["arrived", "stopped by a collision"])
def test_the_other_door_is_taken_when_someone_stands_in_the_first(local: str, parked: str) -> None:
    result = irsim.run(text=scene(parked, f"{{name: follow, local: {local}}}"))
    assert result.robots[1].outcome == "success", result.reason


@pytest.mark.parametrize("local", ["orca", "dash"])
def test_who_stands_in_the_only_door_is_named(local: str) -> None:
    result = irsim.run(text=scene(ARRIVES, f"{{name: follow, local: {local}}}", doors="one"))
    assert result.robots[1].outcome == "timeout"
    assert "there is no way round 'robot_0', which has arrived there" in result.reason
    assert "after_arrival: yield" in result.reason
    named = [event.partner for event in result.events if event.kind == "no_path"]
    assert named == ["robot_0"]


def test_no_one_is_told_to_write_what_is_written() -> None:
    result = irsim.run(text=scene(ARRIVES, "{name: follow, local: orca}", doors="one", after="yield"))
    assert result.robots[1].outcome == "timeout"
    assert "no way round 'robot_0', which has arrived there (move the goal of 'robot_0' aside)" in result.reason


def test_a_dry_run_names_who_stands_in_the_way() -> None:
    report = irsim.validate(text=scene(ARRIVES, "{name: follow, local: orca}", doors="one"), simulate=True)
    assert report.dry_run is not None
    assert any("no way round 'robot_0'" in stuck.why for stuck in report.dry_run.stuck)


def test_a_path_that_nobody_stands_on_stays() -> None:
    free = irsim.run(
        text=scene("state: [5, 10, 0], goal: [5, 11], behavior: {name: dash}", "{name: follow, local: orca}")
    )
    assert free.robots[1].outcome == "success"
    assert free.robots[1].path_length < 17.6
