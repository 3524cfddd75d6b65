"""Draws of tasks: slip and grip of zones, rates and latencies of sensors, equal to scenarios that say the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from irsim.common.arrays import Floats
from irsim.learning.tasks.files import TaskError
from irsim.learning.worlds import Worlds
from tests.learning.tasks import LIDAR, NOISY, task

WET = {"name": "wet", "rectangle": [0, 0, 10, 10], "slip": 0.2}
ICE = {**WET, "slip_std": 0.1, "grip": 0.8}
CAR = {"kinematics": {"name": "single_track"}, "vel_max": [8, 1], "vel_min": [-1, -1], "state": [1, 5, 0, 0, 4, 0, 0]}
USUAL: dict[str, Any] = {"speed": {"learners": [1, 1]}}
"""A draw without effect: episodes of a task with draws are scenes of their own."""
TIMED: list[dict[str, Any]] = [
    {**NOISY, "rate": 2.0, "latency": 0.3},
    {"name": "localization", "latency": 0.2},
    {"name": "imu", "gyro_noise": 0.1, "rate": 5.0},
]
WALL = {"shape": {"name": "rectangle", "length": 1, "width": 60}, "state": [8, 5, 0]}


def on_ground(zone: dict[str, Any], robot: dict[str, Any] | None = None, **keys: Any) -> dict[str, Any]:
    """A task of a robot in a world with one ground."""
    return task(robot or {}, world={"zones": [zone], "collision_mode": "unobstructed"}, **keys)


def driven(made: dict[str, Any], copies: int = 1, steps: int = 8) -> Worlds:
    """Worlds after some steps straight ahead, with a bit of a turn."""
    worlds = Worlds(made, copies, seed=4)
    for _ in range(steps):
        worlds.step(np.array([[1.0, 0.3]] * copies * len(made["scenario"]["robot"])))
    return worlds


def shown(worlds: Worlds, steps: int) -> Floats:
    """(steps, numbers) of what all sensors show."""
    rows = []
    for _ in range(steps):
        worlds.step(np.array([[1.0, 0.3]] * worlds.simulation.copies))
        rows.append(np.concatenate([worlds.simulation.ranges.ravel(), worlds.simulation.state.readings.ravel()]))
    return np.array(rows)


def test_each_robot_slips_as_it_was_drawn() -> None:
    worlds = Worlds(on_ground(WET, randomize={"slip": {"learners": [0.5, 2.0]}, "observed": ["slip"]}), 60, seed=1)
    start = worlds.simulation.pose[worlds.rows, 0].copy()
    for _ in range(10):
        worlds.step(np.array([[1.0, 0.0]] * 60))
    factor = worlds.drawn["slip.learners"].reshape(-1)
    assert 0.5 <= factor.min() < 0.7 < 1.8 < factor.max() <= 2.0
    assert worlds.simulation.pose[worlds.rows, 0] - start == pytest.approx(1 - 0.2 * factor)
    assert worlds.observe()[:, -1] == pytest.approx((factor - 0.5) / 1.5, abs=1e-6)


@pytest.mark.parametrize(
    ("key", "factor", "written", "robot"),
    [
        ("slip", 1.5, {"slip": 0.2 * 1.5, "slip_std": 0.1 * 1.5}, {}),
        ("slip", 0.0, {"slip": 0.0, "slip_std": 0.0}, {}),
        ("slip", 100.0, {"slip": 1.0, "slip_std": 0.0}, {}),
        ("grip", 0.25, {"grip": 0.8 * 0.25}, CAR),
    ],
)
def test_a_drawn_ground_is_that_of_the_same_numbers(
    key: str, factor: float, written: dict[str, Any], robot: dict[str, Any]
) -> None:
    zone = {**ICE, "slip_std": 0.0} if factor == 100 else ICE
    drawn = driven(on_ground(zone, robot, randomize={key: {"learners": [factor, factor]}}))
    same, plain = (driven(on_ground(one, robot, randomize=USUAL)) for one in ({**zone, **written}, zone))
    assert drawn.simulation.pose == pytest.approx(same.simulation.pose, abs=1e-12)
    assert not np.array_equal(drawn.simulation.pose, plain.simulation.pose)


def test_new_draws_leave_the_others_as_they_are() -> None:
    given = {"speed": {"learners": [0.5, 1.5]}, "number": {"obstacle[0]": [0, 3]}}
    new = {name: {"learners": [1, 2]} for name in ("slip", "sensor_rate", "sensor_latency")}
    boxes = [{"number": 3, "shape": {"name": "circle"}, "state": [[8, 1], [8, 3], [8, 8]]}]
    before, now = (
        Worlds(on_ground(ICE, {"sensors": TIMED}, obstacles=boxes, randomize=one), 30, seed=1)
        for one in (given, {**given, **new})
    )
    for name in before.drawn:
        assert np.array_equal(before.drawn[name], now.drawn[name])
    names = [f"{name}.learners" for name in ("speed", *new)]
    columns = np.array([now.drawn[name].reshape(-1) for name in names])
    assert np.abs(np.corrcoef(columns) - np.eye(4)).max() < 0.6


@pytest.mark.parametrize(
    ("randomize", "change"),
    [
        ({"sensor_rate": 0.4}, lambda one: {"rate": 0.4 * one["rate"]} if "rate" in one else {}),
        ({"sensor_rate": 3.0}, lambda one: {"rate": 3.0 * one["rate"]} if "rate" in one else {}),
        ({"sensor_latency": 0.0}, lambda one: {"latency": 0.0} if "latency" in one else {}),
        ({"sensor_latency": 4.0}, lambda one: {"latency": 4.0 * one["latency"]} if "latency" in one else {}),
    ],
)
def test_drawn_times_are_those_of_the_same_numbers(randomize: dict[str, float], change: Any) -> None:
    given = {name: {"learners": [factor, factor]} for name, factor in randomize.items()}
    drawn = Worlds(task({"sensors": TIMED}, obstacles=[WALL], randomize=given, horizon=2), 1, seed=3)
    written = [{**one, **change(one)} for one in TIMED]
    same, plain = (
        Worlds(task({"sensors": sensors}, obstacles=[WALL], randomize=USUAL, horizon=2), 1, seed=3)
        for sensors in (written, TIMED)
    )
    one, other, usual = (shown(worlds, 45) for worlds in (drawn, same, plain))  # over the end of two episodes
    assert np.array_equal(one, other, equal_nan=True)
    assert not np.array_equal(one, usual, equal_nan=True)


def test_worlds_with_other_latencies_are_what_each_is_alone() -> None:
    given = {"sensor_latency": {"learners": [0.0, 8.0]}, "sensor_rate": {"learners": [0.3, 6.0]}}
    made = task({"sensors": TIMED}, obstacles=[WALL], randomize=given, horizon=2)
    alone = [shown(Worlds(made, 1, seed=seed), 30) for seed in range(4)]
    together = Worlds(made, 4, seed=0)
    beams, numbers = (values.size // 4 for values in (together.simulation.ranges, together.simulation.state.readings))
    rows = shown(together, 30)
    for world in range(4):
        ranges = rows[:, world * beams : (world + 1) * beams]
        readings = rows[:, 4 * beams + world * numbers : 4 * beams + (world + 1) * numbers]
        assert np.array_equal(np.concatenate([ranges, readings], axis=1), alone[world], equal_nan=True)


@pytest.mark.parametrize(
    ("made", "randomize", "message"),
    [
        (task(), {"slip": {"learners": [0, 2]}}, "no zone of the scenario has a slip that could be drawn"),
        (on_ground(WET), {"grip": {"learners": [0.5, 2]}}, "no drive of 'learners' feels the grip of zones"),
        (task({"sensors": [LIDAR]}), {"sensor_rate": {"learners": [1, 2]}}, "no sensor of 'learners' has a rate"),
        (task(), {"sensor_latency": {"learners": [1, 2]}}, "no sensor of 'learners' has a latency"),
        (
            task({"sensors": [{**LIDAR, "latency": 4}]}),
            {"sensor_latency": {"learners": [1, 3]}},
            "a latency of 12 s would be longer than 10 s",
        ),
    ],
)
def test_draws_without_effect_are_refused(made: dict[str, Any], randomize: dict[str, Any], message: str) -> None:
    with pytest.raises(TaskError, match=message):
        Worlds({**made, "randomize": randomize}, 1)
