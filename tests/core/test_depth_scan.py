"""Depth cameras as scans: noise by the depth, and otherwise the numbers of a lidar."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from irsim.components.sensors._realism import LidarRealism
from tests.core.distributions import assert_standard_normal
from tests.core.worlds import SCAN, lidar, line, obstacle, robot, scene

ERRORS = LidarRealism().kernel(10.0, 0.01, 0.1)
DEPTH: dict[str, Any] = {"depth_min": 0.0, "depth_std": 0.0, "depth_growth": 0.0, "depth_from": 0.0}


def depth_scan(number: int = 5, **overrides: Any) -> core.DepthScanOptions:
    given = {**SCAN, **DEPTH, "angle_range": 1.2, "number": number, "angle_std": 0.0, "has_velocity": False}
    return core.DepthScanOptions(**{**given, "realism": ERRORS, **overrides})


def ranges(sensor: Any, depth: float, seeds: Any = (0,)) -> tuple[np.ndarray, np.ndarray]:
    """Ranges and which are valid, (W, beams), before a wall straight across."""
    wall = obstacle(parts=[line((depth, -20), (depth, 20))])
    world, state = scene(robot(sensors=[sensor], behavior=None), wall, seeds=seeds, mode=1)
    core.advance(world, state, 1)
    return state.ranges.reshape(len(seeds), -1), state.valid.reshape(len(seeds), -1)


def test_noise_follows_the_depth_and_not_the_range() -> None:
    sensor = depth_scan(depth_std=0.002, depth_growth=0.004, depth_from=0.4)
    read, _ = ranges(sensor, 2.0, seeds=range(10_000))
    angles = np.linspace(-0.6, 0.6, 5)
    sigma = 0.002 + 0.004 * 1.6**2
    depths = read * np.cos(angles)
    for beam in range(5):
        assert_standard_normal((depths[:, beam] - 2.0) / sigma)


def test_noise_grows_with_the_square_of_the_depth() -> None:
    at = np.array([0.5, 1.0, 2.0, 4.0])
    spread = [ranges(depth_scan(1, depth_growth=0.0025), z, seeds=range(20_000))[0].std() for z in at]
    slope = float(at**2 @ spread / (at**2 @ at**2))
    assert slope == pytest.approx(0.0025, rel=0.02)


def test_surfaces_at_too_small_a_depth_return_nothing() -> None:
    read, valid = ranges(depth_scan(depth_min=0.5), 0.49)
    assert (read == 10.0).all()
    assert not valid.any()
    read, valid = ranges(depth_scan(depth_min=0.5), 0.51)
    assert read[0] == pytest.approx(0.51 / np.cos(np.linspace(-0.6, 0.6, 5)))
    assert valid.all()


def test_without_errors_of_depth_it_is_a_lidar() -> None:
    """The same draws, too: noise and the errors of `realism` are as in a lidar."""
    harsh = LidarRealism(dropout=0.1, std_per_meter=0.02, short_share=0.1, divergence=0.02).kernel(10.0, 0.01, 0.1)
    shared: dict[str, Any] = {"angle_range": 1.2, "noise": True, "std": 0.05, "angle_std": 0.02, "realism": harsh}
    for seed in range(3):
        of_lidar, of_camera = (ranges(one, 2.0, (seed,)) for one in (lidar(40, **shared), depth_scan(40, **shared)))
        np.testing.assert_array_equal(of_lidar[0], of_camera[0])
        np.testing.assert_array_equal(of_lidar[1], of_camera[1])


def test_worlds_of_a_batch_measure_what_they_measure_alone() -> None:
    sensor = depth_scan(9, depth_growth=0.01)
    together, _ = ranges(sensor, 2.0, seeds=(3, 4, 5))
    np.testing.assert_array_equal(together, [ranges(sensor, 2.0, seeds=(seed,))[0][0] for seed in (3, 4, 5)])
    assert math.isfinite(together.sum())
