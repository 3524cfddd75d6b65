"""Scans that take time, against beams that are cast one by one from where the sensor was."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely

import irsim._core as core
from tests.core.test_lidar_errors import OFF
from tests.core.worlds import circle, fmcw, lidar, line, obstacle, robot, scene

ROOM = [(-5.0, -3.0), (5.0, -3.0), (5.0, 3.0), (-5.0, 3.0), (-5.0, -3.0)]
DT = 0.1
BEAMS = 360


def swept(segments: int, **overrides: Any) -> core.LidarErrors:
    return core.LidarErrors(**{**OFF, "beam_time": DT / BEAMS, "segments": segments, **overrides})


def pose_at(start: np.ndarray, speed: float, yaw_rate: float, time: float) -> tuple[float, float, float]:
    """The pose on an arc after some time [s]."""
    x, y, theta = start
    if yaw_rate == 0.0:
        return x + speed * time * math.cos(theta), y + speed * time * math.sin(theta), theta
    radius, end = speed / yaw_rate, theta + yaw_rate * time
    return x + radius * (math.sin(end) - math.sin(theta)), y - radius * (math.cos(end) - math.cos(theta)), end


def errors_of(segments: int, speed: float, yaw_rate: float, others: tuple[float, ...] = ()) -> np.ndarray:
    """Differences of a swept scan from its beams cast one by one; ``others`` are speeds of discs along y."""
    sensor = lidar(BEAMS, range_max=20.0, endpoint=False, angle_std=0.0, realism=swept(segments))
    moving = [robot(pose=[2.0, 1.0 - k, 0.5 * math.pi], parts=[circle(0.3)], control=[speed, 0, 0], behavior=None,
                       vel_max=[5, 5, 5], vel_min=[-5, -5, -5]) for k, speed in enumerate(others)]  # fmt: skip
    world, state = scene(
        robot(pose=[-1, 0.5, 0.3], control=[speed, yaw_rate, 0], vel_max=[5, 5, 5], behavior=None, sensors=[sensor]),
        obstacle(pose=[0, 0, 0], parts=[line(*ROOM)], static=True),
        *moving,
        mode=1,
    )
    world.integration = 1
    rows = [0, *range(2, 2 + len(others))]
    starts = state.pose[rows].copy()
    state.command[0, :2], state.given[0] = [speed, yaw_rate], 1
    for row, own in zip(rows[1:], others, strict=True):
        state.command[row, :2], state.given[row] = [own, 0.0], 1
    core.advance(world, state, 1)
    expected = []
    for i in range(BEAMS):
        time = DT - (BEAMS - 1 - i) * DT / BEAMS
        x, y, theta = pose_at(starts[0], speed, yaw_rate, time)
        angle = theta + state.beam_angles[i]
        beam = shapely.LineString([(x, y), (x + 20 * math.cos(angle), y + 20 * math.sin(angle))])
        walls = [shapely.LineString(ROOM)]
        for start, own in zip(starts[1:], others, strict=True):
            at = pose_at(start, own, 0.0, time)
            walls.append(shapely.Point(at[:2]).buffer(0.3, quad_segs=200).exterior)
        hits = beam.intersection(shapely.union_all(walls))
        expected.append(shapely.Point(x, y).distance(hits))
    return np.asarray(state.ranges) - expected


def test_a_fast_turn_errs_by_less_than_a_centimetre() -> None:
    error = errors_of(8, 2.0, 2.0)
    assert np.abs(error).max() < 0.002
    assert math.sqrt(np.mean(error**2)) < 0.0002


@pytest.mark.parametrize("segments", [2, 4, 16])
def test_few_segments_are_exact_enough(segments: int) -> None:
    """Within a segment ranges follow the motion as if surfaces were planes; corners are where that is not so."""
    assert np.abs(errors_of(segments, 2.0, 2.0)).max() < 0.004


def test_a_sensor_at_rest_sees_what_it_sees_at_once() -> None:
    assert np.abs(errors_of(8, 0.0, 0.0)).max() < 1e-12


def test_directions_are_exact_when_it_only_turns() -> None:
    assert np.abs(errors_of(8, 0.0, 3.0)).max() < 1e-9


def test_others_are_seen_where_they_were() -> None:
    error = np.abs(errors_of(16, 0.0, 0.0, (2.0, -1.5)))
    assert np.quantile(error, 0.98) < 0.005
    assert np.mean(error > 0.02) < 0.02  # beams that pass a disc in one place and meet it in the other


def test_noise_of_a_swept_scan_is_that_of_all_its_beams() -> None:
    """Beams of all parts draw different numbers, the same as in a scan that takes no time."""
    for make in (lidar, fmcw):
        scans = []
        for realism in (core.LidarErrors(**{**OFF, "dropout": 0.2}), swept(8, dropout=0.2)):
            sensor = make(BEAMS, noise=True, std=0.1, angle_std=0.0, endpoint=False, realism=realism)
            world, state = scene(
                robot(sensors=[sensor]), obstacle(pose=[0, 0, 0], parts=[line(*ROOM)], static=True), mode=1
            )
            core.advance(world, state, 2)
            scans.append(np.array(state.ranges))
        np.testing.assert_allclose(scans[0], scans[1], atol=1e-12)
