"""A differential drive with mass and motors: fine integration, limits of torque and voltage, energy, and driving."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from irsim.components.kinematics.diff_dynamic import DiffDynamic
from tests.core.driving import EXACT, driven, fine
from tests.core.worlds import assert_success, robot, scene

USUAL = DiffDynamic()


def base(**options: Any) -> core.DiffDynamicOptions:
    values = {name: getattr(USUAL, name) for name in core.DiffDynamicOptions.fields}
    return core.DiffDynamicOptions(
        **{**values, "alpha": [0.03, 0.0, 0.0, 0.03], "friction": math.inf, "slip_stiffness": math.inf, **options}
    )


def speeds(path: np.ndarray) -> np.ndarray:
    """(K, 2) forward speed [m/s] and yaw rate [rad/s] from the rates of the wheels."""
    left, right = USUAL.wheel_radius * path[:, 3], USUAL.wheel_radius * path[:, 4]
    return np.column_stack([(left + right) / 2, (right - left) / USUAL.track])


def at(v: float, w: float = 0.0) -> list[float]:
    half = USUAL.track / 2
    return [0.0, 0.0, 0.0, (v - half * w) / USUAL.wheel_radius, (v + half * w) / USUAL.wheel_radius]


def test_within_its_limits_the_speed_answers_with_its_time_constant() -> None:
    path = driven(base(response=0.5, torque_max=math.inf), at(0.0), [[0.5, 0.8]] * 10)
    reached = speeds(path)[5]
    assert reached == pytest.approx([0.5 * (1 - math.exp(-1)), 0.8 * (1 - math.exp(-1))], rel=1e-7)


def test_torque_over_mass_limits_the_acceleration() -> None:
    path = driven(base(drag=0.0, torque_max=1.0, response=0.01), at(0.0), [[9.0, 0.0]] * 4)
    assert speeds(path)[:, 0] == pytest.approx(2 * 1.0 / 0.08 / 10.0 * 0.1 * np.arange(5))
    assert path[4, 0] == pytest.approx(0.5 * 2.5 * 0.4**2, rel=1e-9)


def test_the_voltage_limits_the_top_speed() -> None:
    path = driven(base(drag=0.0), at(0.0), [[9.0, 0.0]] * 300)
    assert speeds(path)[-1, 0] == pytest.approx(12.0 / (0.03 * 20) * 0.08, rel=1e-6)
    slowed = driven(base(drag=8.0), at(0.0), [[9.0, 0.0]] * 300)
    motor = 0.03 * 20 / 0.08
    assert speeds(slowed)[-1, 0] == pytest.approx(2 * motor / 2.0 * 12 / (2 * motor**2 / 2.0 + 8.0), rel=1e-6)


def test_ten_seconds_are_those_of_fine_integration() -> None:
    u, r, half = USUAL, USUAL.wheel_radius, USUAL.track / 2
    scale = u.torque_constant * u.gear / u.resistance
    most = u.torque_max or math.inf

    def rates(y: np.ndarray, control: Any) -> np.ndarray:
        v, w = r * (y[3] + y[4]) / 2, r * (y[4] - y[3]) / (2 * half)
        force = u.mass * (control[0] - v) / u.response + u.drag * v
        moment = u.inertia * (control[1] - w) / u.response + u.turn_drag * w
        torques = []
        for side, rate in ((-1, y[3]), (1, y[4])):
            own = u.torque_constant * u.gear * rate
            wanted = force * r / 2 + side * moment * r / (2 * half)
            low, high = scale * (-12.0 - own), scale * (12.0 - own)
            torques.append(min(max(min(max(wanted, low), high), -most), most))
        a = (sum(torques) / r - u.drag * v) / u.mass
        turn = ((torques[1] - torques[0]) * half / r - u.turn_drag * w) / u.inertia
        return np.array([v * math.cos(y[2]), v * math.sin(y[2]), w, (a - half * turn) / r, (a + half * turn) / r])

    time = 0.1 * np.arange(100)
    controls = np.column_stack([1.3 * np.sign(np.sin(0.9 * time)), 1.5 * np.cos(1.7 * time)]).tolist()
    ours, exact = driven(base(), at(0.0), controls), fine(rates, at(0.0), controls, parts=200)
    assert np.abs(ours[:, :2] - exact[:, :2]).max() < 1e-3
    assert np.abs(ours[:, 3:] - exact[:, 3:]).max() < 1e-2


@pytest.mark.parametrize(("v", "w"), [(1.2, 0.0), (0.8, 3.0), (-1.0, -4.0), (30.0, 0.0)])
def test_energy_never_grows_when_braking(v: float, w: float) -> None:
    for drive in (base(), base(response=0.001), base(mass=500.0), base(voltage=0.5)):
        reached = speeds(driven(drive, at(v, w), [[0.0, 0.0]] * 400, 0.05))
        energy = 0.5 * drive.mass * reached[:, 0] ** 2 + 0.5 * drive.inertia * reached[:, 1] ** 2
        assert (np.diff(energy) <= 1e-12 * energy[0]).all()
        assert energy[-1] < 0.95 * energy[0]


@pytest.mark.parametrize("dt", [0.1, 0.2])
def test_light_stiff_and_heavy_ones_are_stable(dt: float) -> None:
    rng = np.random.default_rng(3)
    controls = rng.uniform(-5, 5, (80, 2)).tolist()
    light = base(mass=0.01, inertia=1e-5)
    for drive in (light, base(response=0.001), base(resistance=0.001), base(mass=1e5, inertia=1e5)):
        path = driven(drive, at(3.0, -9.0), controls, dt)
        assert np.isfinite(path).all()
        assert np.abs(speeds(path)[5:]).max() < 40.0


def test_a_constant_command_gives_a_circle() -> None:
    path = driven(base(), at(0.6, 0.9), [[0.6, 0.9]] * 300)
    radius = 0.6 / 0.9
    np.testing.assert_allclose(np.hypot(path[:, 0], path[:, 1] - radius), radius, atol=1e-6)


def test_one_world_of_a_batch_is_that_world_alone() -> None:
    def run(seeds: list[int]) -> np.ndarray:
        world, state = scene(robot(drive=base(noise=True), goals=[[8, 8, 0]], acce=[2, 4, 1]), seeds=seeds)
        world.integration = EXACT
        core.advance(world, state, 60, threads=2)
        return np.column_stack([state.pose, state.extra])

    together = run([3, 4, 5])
    assert together[1].tobytes() == run([4])[0].tobytes()
    assert not np.array_equal(together[0], together[1])


ROOM = """
world: {width: 10, height: 8, integration: exact, time_limit: 60}
robot: {kinematics: {name: diff_dynamic, mass: 30, inertia: 1.5, torque_max: 3}, state: [1, 1, 2], goal: [9, 7],
        behavior: %s}
obstacle:
  - {shape: {name: circle, radius: 0.5}, state: [3, 2.6, 0]}
  - {shape: {name: rectangle, length: 0.3, width: 5}, state: [6, 2.5, 0]}
"""


@pytest.mark.parametrize("local", ["dash", "orca", "rvo", "sfm", "avocado", "footprint_orca"])
def test_it_follows_a_planned_path(local: str) -> None:
    assert_success(ROOM % f"{{name: follow, local: {{name: {local}}}}}", seed=1)


def test_it_avoids_others_that_come_towards_it() -> None:
    text = """
world: {width: 10, height: 6, integration: exact, time_limit: 60}
robot:
  - {number: 4, kinematics: {name: diff_dynamic}, distribution: {name: circle, center: [5, 3], radius: 2.5},
     shape: {name: circle, radius: 0.2}, behavior: {name: %s}}
"""
    for behavior in ("orca", "footprint_orca", "avocado"):
        assert_success(text % behavior, seed=2)
