"""A tricycle: its motion by hand and against fine integration, how its wheel turns, and that everything drives it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim
import irsim._core as core
from tests.core.driving import EULER, EXACT, driven, fine
from tests.core.worlds import PI, assert_success, collisions, robot, scene

INF = math.inf
BASE = 1.2


def tricycle(**options: Any) -> core.TricycleOptions:
    usual: dict[str, Any] = {
        "noise": False, "alpha": [0.03, 0.0, 0.0, 0.03], "mode": "steer", "wheelbase": BASE, "psi_max": PI / 2,
        "steer_rate": INF, "steer_acce": INF, "steer_lag": 0.0,
    }  # fmt: skip
    return core.TricycleOptions(**{**usual, **options})


def test_one_step_by_hand() -> None:
    state, twist = core.drive_step(tricycle(), [1, 2, 0.5, 0.6, 0], [2.0, -0.3], 0.1, EULER)
    forward, rate = 2 * math.cos(0.6), 2 * math.sin(0.6) / BASE
    assert state[:3] == pytest.approx(
        [1 + 0.1 * forward * math.cos(0.5), 2 + 0.1 * forward * math.sin(0.5), 0.5 + 0.1 * rate]
    )
    assert state[3] == -0.3, "the wheel turns at the end of the step"
    assert twist == pytest.approx([forward * math.cos(0.5), forward * math.sin(0.5), rate])


def test_at_a_quarter_turn_it_turns_about_the_middle_of_its_rear_axle() -> None:
    state = driven(tricycle(), [3, 4, 0.2, PI / 2, 0], [[0.6, PI / 2]] * 50)
    np.testing.assert_allclose(state[:, :2], [[3, 4]] * 51, atol=1e-12)
    turned = np.unwrap(state[:, 2])
    np.testing.assert_allclose(np.diff(turned), 0.1 * 0.6 / BASE, atol=1e-12)


@pytest.mark.parametrize("options", [{}, {"steer_rate": 2.0, "steer_acce": 5.0, "steer_lag": 0.1}])
@pytest.mark.parametrize("psi", [0.3, -1.0, 1.5])
def test_a_constant_angle_gives_a_circle(psi: float, options: dict[str, float]) -> None:
    path = driven(tricycle(**options), [0, 0, 0, psi, 0], [[1.0, psi]] * 300)
    radius = BASE / math.tan(psi)
    np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1] - radius), abs(radius), atol=1e-6)


def test_the_angle_follows_its_lag_and_its_limits() -> None:
    lagged = driven(tricycle(steer_lag=0.5), [0, 0, 0, 0, 0], [[1.0, 0.8]] * 5)
    assert lagged[5, 3] == pytest.approx(0.8 * (1 - math.exp(-1)), rel=1e-12), "63.2 % after the time constant"
    limited = driven(tricycle(steer_rate=0.5), [0, 0, 0, 0, 0], [[1.0, 0.8]] * 20)
    assert limited[:, 3] == pytest.approx(np.minimum(0.8, 0.05 * np.arange(21)))
    both = driven(tricycle(steer_rate=0.5, steer_lag=0.4), [0, 0, 0, 0, 0], [[1.0, 0.8]] * 40)
    time = 0.1 * np.arange(41)
    late = 0.8 - 0.2 * np.exp((1.2 - time) / 0.4)  # from 0.2 rad on the lag is slower than the limit
    assert both[:, 3] == pytest.approx(np.where(time < 1.2, 0.5 * time, late), abs=1e-12)


def test_the_wheel_neither_jerks_nor_overshoots() -> None:
    path = driven(tricycle(steer_rate=1.0, steer_acce=2.0), [0, 0, 0, 0, 0], [[0.0, 1.2]] * 40)
    assert np.abs(np.diff(path[:, 4])).max() <= 2.0 * 0.1 + 1e-9
    assert path[:, 4].max() == pytest.approx(1.0)
    assert path[:, 3].max() <= 1.2 + 1e-9
    assert path[-1, 3] == pytest.approx(1.2, abs=1e-6)
    assert path[:6, 3] == pytest.approx(0.5 * 2.0 * (0.1 * np.arange(6)) ** 2, abs=0.006)


def test_rate_control_stops_at_the_largest_angle() -> None:
    path = driven(tricycle(mode="angular", psi_max=0.5, steer_rate=1.0), [0, 0, 0, 0, 0], [[1.0, 3.0]] * 8)
    assert path[:, 3] == pytest.approx(np.minimum(0.5, 0.1 * np.arange(9)))
    assert path[-1, 4] == 0.0


@pytest.mark.parametrize(
    ("options", "lag"),
    [({"steer_lag": 0.2}, 0.2), ({"steer_lag": 0.3, "mode": "angular", "psi_max": 1.5}, 0.3)],
)
def test_ten_seconds_are_those_of_fine_integration(options: dict[str, Any], lag: float) -> None:
    by_rate = options.get("mode") == "angular"
    time = 0.1 * np.arange(100)
    wanted = 0.6 * np.cos(time) if by_rate else 0.9 * np.sin(time)
    controls = np.column_stack([1.5 * np.cos(0.4 * time), wanted])

    def rates(y: np.ndarray, u: Any) -> np.ndarray:
        forward, turn = u[0] * math.cos(y[3]), u[0] * math.sin(y[3]) / BASE
        steered = [y[4], (u[1] - y[4]) / lag] if by_rate else [(u[1] - y[3]) / lag, 0.0]
        return np.array([forward * math.cos(y[2]), forward * math.sin(y[2]), turn, *steered])

    ours = driven(tricycle(**options), [0, 0, 0, 0, 0], controls.tolist())
    exact = fine(rates, [0, 0, 0, 0, 0], controls.tolist(), parts=100)
    assert np.abs(ours[:, :2] - exact[:, :2]).max() < 1e-3
    np.testing.assert_allclose(ours[:, 3], exact[:, 3], atol=1e-6)


def test_the_twist_leads_from_pose_to_pose() -> None:
    before = [1.0, 1.0, 0.4, 0.2, 0.0]
    after, twist = core.drive_step(tricycle(steer_rate=2.0), before, [1.5, 1.0], 0.2, EXACT)
    half = 0.1 * twist[2]
    chord = 0.2 * math.sin(half) / half
    c, s = math.cos(half), math.sin(half)
    moved = [chord * (c * twist[0] - s * twist[1]), chord * (s * twist[0] + c * twist[1])]
    assert [1.0 + moved[0], 1.0 + moved[1], 0.4 + 0.2 * twist[2]] == pytest.approx(after[:3], abs=1e-12)


def test_one_world_of_a_batch_is_that_world_alone() -> None:
    def run(seeds: list[int]) -> np.ndarray:
        drive = tricycle(noise=True, steer_rate=1.0)
        world, state = scene(robot(drive=drive, extra=[0.1, 0.0], goals=[[8, 8, 0]], vel_max=[1, 1.5, 1]), seeds=seeds)
        world.integration = EXACT
        core.advance(world, state, 60, threads=2)
        return np.column_stack([state.pose, state.extra])

    together = run([3, 4, 5])
    assert together[1].tobytes() == run([4])[0].tobytes()
    assert not np.array_equal(together[0], together[1])


DOORWAY = """
world: {width: 10, height: 6, step_time: 0.1, integration: exact, time_limit: 60}
robot:
  name: truck
  kinematics: {name: tricycle, wheelbase: 0.5, steer_rate: 1.5, steer_lag: 0.1}
  shape: {name: rectangle, length: 0.8, width: 0.4}
  state: [1, 1, 3.1]
  goal: [9, 5, 0]
  vel_max: [1, 1.5]
  vel_min: [-1, -1.5]
  behavior: %s
obstacle:
  - {shape: {name: rectangle, length: 0.3, width: 3.6}, state: [5, 1.2, 0]}
"""


@pytest.mark.parametrize("local", ["dash", "orca", "rvo", "sfm", "avocado", "footprint_orca"])
def test_it_follows_a_planned_path_through_a_doorway(local: str) -> None:
    assert_success(DOORWAY % f"{{name: follow, local: {{name: {local}}}}}", seed=1)


def test_it_turns_where_a_car_of_its_size_cannot() -> None:
    """A goal beside it, within its turning circle as a car."""
    text = """
world: {width: 6, height: 6, time_limit: 30, integration: exact}
robot: {kinematics: {name: %s, wheelbase: 1.2}, state: [3, 3, 0], goal: [3, 3.6], vel_max: [0.5, %s],
        behavior: {name: dash}}
"""
    assert irsim.run(text=text % ("tricycle", 1.57), seed=1).outcome == "success"
    assert irsim.run(text=text % ("acker", 0.9), seed=1).outcome == "timeout"


def test_two_that_meet_head_on_under_forces_do_not_touch() -> None:
    """Nothing is free ahead then: the wheel must not creep on, though it turns aside."""
    text = """
world: {width: 14, height: 14, integration: exact, time_limit: 20}
robot: {number: 2, kinematics: {name: tricycle}, distribution: {name: circle, center: [7, 7], radius: 5},
        shape: {name: circle, radius: 0.25}, behavior: {name: sfm}}
"""
    assert collisions(irsim.run(text=text, seed=0)) == []
