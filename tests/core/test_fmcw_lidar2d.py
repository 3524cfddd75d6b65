"""FMCW lidar: ranges equal a lidar's, radial velocities equal the closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

import irsim._core as core
from tests.core import oracle
from tests.core.worlds import DRIVES, PI, apply, circle, fmcw, lidar, obstacle, rectangle, robot, scene
from tests.effort import for_all


def facing(own: list[float], other: list[float], heading: float, **options) -> core.State:
    """A robot at the origin that looks along x at another one 3 m ahead; both drive with these controls."""
    _, state = scene(
        robot(control=own, sensors=[fmcw(1, **options)]),
        robot(pose=[3, 0, heading], parts=[rectangle(1, 1)], control=other),
        mode=1,
    )
    return state


def test_outside_the_band_is_no_measurement() -> None:
    for options, read in (({"range_max": 2.0}, 2.0), ({"range_min": 2.7}, 2.7)):
        state = facing([0.5, 0], [0.8, 0], PI, **options)
        assert (state.ranges[0], state.valid[0], state.velocities[0]) == (read, 0, 0.0)
    state = facing([0.5, 0], [0.8, 0], PI, range_min=2.5, range_max=2.5)
    assert (state.valid[0], state.velocities[0]) == (1, pytest.approx(-1.3))


def moving_worlds(rng: np.random.Generator, sensors: list, count: int) -> list[core.ObjectSpec]:
    objects = [robot(pose=rng.uniform([-1, -1, -PI], [1, 1, PI]).tolist(), control=[0.6, 0.3], sensors=sensors)]
    for k in range(count):
        drive = ["diff", "omni", "omni_angular", "steer"][k % 4]
        objects.append(
            robot(
                pose=[*rng.uniform(-5, 5, 2), rng.uniform(-PI, PI)],
                drive=DRIVES[drive],
                parts=[[circle(0.4), rectangle(0.8, 0.5)][k % 2]],
                control=rng.uniform(-1, 1, 3).tolist(),
                vel_min=[-2.0] * 3,
                vel_max=[2.0] * 3,
                static=k % 5 == 4,
            )
        )
    return objects


def world_velocity(state: core.State, row: int, drive: str) -> np.ndarray:
    """Velocity of an object, from its control and pose."""
    theta, control = state.pose[row, 2], state.control[row]
    if drive.startswith("omni"):
        return oracle.rotation(theta) @ control[:2]
    return control[0] * np.array([math.cos(theta), math.sin(theta)])


@for_all(60, seed=st.integers(0, 10_000), compensate=st.booleans(), mounted=st.sampled_from([0.0, 0.7, -2.5]))
def test_every_beam_reads_the_projected_velocity(seed: int, compensate: bool, mounted: float) -> None:
    rng = np.random.default_rng(seed)
    sensor = fmcw(37, offset=[0.1, -0.2, mounted], motion_compensate=compensate)
    count = int(rng.integers(0, 12))
    objects = moving_worlds(rng, [sensor, lidar(37, offset=[0.1, -0.2, mounted], has_velocity=True)], count)
    world, state = scene(*objects, mode=1)
    for _ in range(2):
        apply(world, state, [0.5, -0.4, 0], *(rng.uniform(-1, 1, 3) for _ in range(count)))
        drives = ["diff", *(["diff", "omni", "omni_angular", "steer"][k % 4] for k in range(count))]
        each = np.array([world_velocity(state, row, drive) for row, drive in enumerate(drives)])
        hits, (radial, plain) = state.hits[:37], (state.velocities[:37], state.velocities[37:].reshape(2, 37))
        np.testing.assert_array_equal(state.ranges[:37], state.ranges[37:])
        np.testing.assert_array_equal(hits, state.hits[37:])
        bearing = state.pose[0, 2] + mounted + state.beam_angles[:37]
        along = np.stack([np.cos(bearing), np.sin(bearing)])
        target = np.where(hits >= 0, each[hits].T, 0.0)
        own = np.zeros(2) if compensate else each[0]
        expected = np.where(hits >= 0, ((target - own[:, None]) * along).sum(axis=0), 0.0)
        np.testing.assert_allclose(radial, expected, atol=1e-12)
        np.testing.assert_allclose(plain, target, atol=1e-12)


def test_noise_has_its_streams() -> None:
    """Range, direction and velocity errors equal the published draws; velocity noise needs no `noise`."""
    n, wall = 400, obstacle(pose=[4, 0, 0], parts=[rectangle(1, 60)])
    sensors = [
        lidar(3),
        fmcw(n, angle_range=0.6, noise=True, std=0.1, angle_std=0.02, velocity_noise_std=0.3),
        fmcw(n, angle_range=0.6, velocity_noise_std=0.3),
    ]
    world, state = scene(robot(control=[0.5, 0, 0], sensors=sensors), wall, seeds=[3], mode=1)
    apply(world, state, [0.5, 0.1], steps=2)
    draws = int(state.count[0]) * 3 * n + np.arange(3 * n)
    x, _, theta = state.pose[0]
    for index in (1, 2):
        key = (3, 0, 0, core.STREAMS["sensor"] + 16 * index, 0)
        blocks = {d: oracle.normals(core.random_bits(*key, int(d))) for d in np.unique(draws // 4)}
        errors = np.array([blocks[d // 4][d % 4] for d in draws]).reshape(3, n)
        noisy = index == 1
        aim = theta + np.linspace(-0.3, 0.3, n) + (0.02 * errors[1] if noisy else 0.0)
        distance = (3.5 - x) / np.cos(aim) + (0.1 * errors[0] if noisy else 0.0)
        first = 3 + (index - 1) * n
        np.testing.assert_allclose(state.ranges[first : first + n], distance, atol=1e-9)
        speed = -0.5 * np.cos(theta - aim) + 0.3 * errors[2]
        start, rows = world.velocity_slices()[index]
        assert rows == 1
        np.testing.assert_allclose(state.velocities[start : start + n], speed, atol=1e-9)
    assert world.velocity_slices()[0][1] == 0


def test_a_scan_from_elsewhere() -> None:
    world, state = scene(robot(sensors=[fmcw(1)], control=[0.4, 0]), obstacle(pose=[5, 0, 0], parts=[rectangle(1, 1)]))
    core.scan(world, state, 0, 0, [1.0, 0.0, 0.0])
    assert (state.ranges[0], state.velocities[0]) == (3.5, pytest.approx(-0.4))
    core.scan(world, state, 0, 0, [1.0, 0.0, PI])
    assert state.ranges[0] == 10.0
    with pytest.raises(IndexError):
        core.scan(world, state, 0, 1, [0, 0, 0])
