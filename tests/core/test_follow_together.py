"""Several objects under follow with orca: they pass doors, corridors and mazes without a jam and without a touch."""

from __future__ import annotations

import itertools
import json
import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.api.read_input import read_scenario
from irsim.navigation.clearances import clearance
from irsim.simulation.simulation import Simulation

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


def assert_all_arrive(name: str, drive: str, seeds: range, share: float) -> None:
    arrived = robots = 0
    for seed in seeds:
        result = irsim.run(text=text_of(name, drive), seed=seed, perturb={"position": 0.1})
        assert not [event for event in result.events if event.kind == "collision"], seed
        arrived += sum(robot.time_to_goal is not None for robot in result.robots)
        robots += len(result.robots)
    assert arrived >= share * robots


@pytest.mark.parametrize("drive", ["omni", "diff"])
def test_three_robots_do_not_jam_in_a_door(drive: str) -> None:
    result = irsim.run(text=text_of("door of 0.9 m", drive), seed=0)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


def test_cars_pass_each_other_in_a_corridor_that_is_wide_enough_for_both() -> None:
    """Their bounding circles do not fit beside each other, their bodies do."""
    result = irsim.run(text=text_of("corridor, both ways", "acker"), seed=0)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


def test_cars_that_block_each_other_at_a_door_back_up_and_go_one_by_one() -> None:
    result = irsim.run(text=text_of("door of 0.9 m", "acker"), seed=0)
    assert result.outcome == "success", result.reason
    assert not [event for event in result.events if event.kind == "collision"]


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
@pytest.mark.parametrize(("name", "drive"), list(itertools.product(SCENES, ["omni", "omni_angular", "diff"])))
def test_nobody_jams_from_starts_that_are_a_little_different(name: str, drive: str) -> None:
    assert_all_arrive(name, drive, range(20), 0.98)


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENES))
def test_cars_do_not_jam_from_starts_that_are_a_little_different(name: str) -> None:
    assert_all_arrive(name, "acker", range(10), 0.98)


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


SLOW_CARS = yaml.safe_load(Path(__file__).with_name("slow_cars.yaml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", SLOW_CARS, ids=lambda case: f"{case['local']}-{case['world']['step_time']}")
def test_cars_that_brake_slowly_touch_nobody(case: dict[str, Any]) -> None:
    car = {
        "kinematics": {"name": "acker"},
        "shape": {"name": "rectangle", "length": 0.6, "width": 0.4, "wheelbase": 0.35},
        "goal_threshold": 0.3,
        "behavior": {"name": "follow", "local": {"name": case["local"]}},
        **case["limits"],
    }
    document = {
        "world": {"width": 15, "height": 15, "boundary": "walls", "contacts": "swept", "time_limit": 60}
        | case["world"],
        "robot": [car | {"state": row[:3], "goal": row[3:]} for row in case["robots"]],
        "obstacle": [
            {"shape": {"name": "rectangle", "length": length, "width": width}, "state": pose}
            for length, width, *pose in case["obstacles"]
        ],
    }
    result = irsim.run(text=yaml.safe_dump(document), seed=1)
    assert not [event for event in result.events if event.kind == "collision"]
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
        cars = [
            {
                "kinematics": {"name": "acker"},
                "shape": {"name": "rectangle", "length": 0.6, "width": 0.4, "wheelbase": 0.35},
                "state": [*start, math.atan2(goal[1] - start[1], goal[0] - start[0])],
                "goal": goal,
                "goal_threshold": 0.3,
                "vel_max": [top, 0.8],
                "vel_min": [-top, -0.8],
                "acce": [acce, 4],
                "behavior": {"name": "follow", "local": {"name": local}},
            }
            for start, goal in ends
        ]
        boxes = [
            {"shape": {"name": "rectangle", "length": 1.2, "width": 0.8}, "state": [*place(0.75), draw.uniform(-3, 3)]}
            for _ in range(4)
        ]
        world = {"width": 12, "height": 12, "boundary": "walls", "contacts": "swept", "time_limit": 40}
        world |= {"step_time": draw.choice([0.1, 0.2, 0.3]), "integration": draw.choice(["euler", "exact"])}
        text = yaml.safe_dump({"world": world, "robot": cars, "obstacle": boxes})
        result = irsim.run(text=text, seed=1)
        assert not [event for event in result.events if event.kind == "collision"], seed
