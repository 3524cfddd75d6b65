"""Odometry, IMU, satellite navigation and localization, against closed forms and statistics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.estimators import allan, umbmark
from tests.core.worlds import DRIVES, PI, command, polygon, robot, scene

ODOMETRY: dict[str, Any] = {
    "track": 0.4, "wheel_radius": 0.1, "ticks_per_turn": 0, "diameter_error": 0.0, "track_error": 0.0,
    "scale_error": 0.0, "diameter_std": 0.0, "track_std": 0.0, "scale_std": 0.0, "distance_noise": 0.0,
    "heading_noise": 0.0, "turning_noise": 0.0,
}  # fmt: skip
IMU: dict[str, Any] = {
    "offset": [0, 0, 0], "gyro_noise": 0.0, "gyro_bias_std": 0.0, "gyro_drift_std": 0.0, "gyro_drift_time": 100.0,
    "gyro_scale_std": 0.0, "gyro_resolution": 0.0, "gyro_range": math.inf, "accel_noise": 0.0, "accel_bias_std": 0.0,
    "accel_drift_std": 0.0, "accel_drift_time": 100.0, "accel_scale_std": 0.0, "accel_resolution": 0.0,
    "accel_range": math.inf, "misalignment_std": 0.0, "tilt_std": 0.0,
}  # fmt: skip
GNSS: dict[str, Any] = {
    "offset": [0, 0, 0], "std": 0.0, "drift_std": 0.0, "drift_time": 100.0, "rtk": False, "fixed_std": 0.01,
    "fixed_time": 20.0, "float_std": 0.3, "float_time": 5.0, "blocked": [], "reflecting": [], "reflection": 3.0,
}  # fmt: skip
PLACE: dict[str, Any] = {
    "position_std": 0.0, "heading_std": 0.0, "time": 5.0, "min_distance": 0.25, "min_turn": 0.2,
    "distance_noise": 0.0, "heading_noise": 0.0, "turning_noise": 0.0, "jumps_per_km": 0.0, "jump_std": 1.0,
}  # fmt: skip


def odometry(**overrides: Any) -> core.OdometryOptions:
    return core.OdometryOptions(**{**ODOMETRY, **overrides})


def imu(**overrides: Any) -> core.ImuOptions:
    return core.ImuOptions(**{**IMU, **overrides})


def gnss(**overrides: Any) -> core.GnssOptions:
    return core.GnssOptions(**{**GNSS, **overrides})


def place(**overrides: Any) -> core.LocalizationOptions:
    return core.LocalizationOptions(**{**PLACE, **overrides})


def carrier(*sensors: Any, dt: float = 0.1, seeds: Any = (0,), **overrides: Any) -> tuple[core.World, core.State]:
    fast = {"vel_max": [9.0] * 3, "vel_min": [-9.0] * 3}
    world, state = scene(
        robot(sensors=list(sensors), behavior=None, **{**fast, **overrides}), seeds=seeds, mode=1, step_time=dt
    )
    world.integration = 1
    return world, state


def drive(world: core.World, state: core.State, control: tuple[float, ...], steps: int) -> np.ndarray:
    """The readings after each of some steps, (steps, W * readings)."""
    out = []
    for _ in range(steps):
        command(state, *[control] * len(state.pose))
        core.advance(world, state, 1)
        out.append(state.readings.copy())
    return np.array(out)


@pytest.mark.parametrize("kind", DRIVES)
def test_odometry_without_errors_is_the_true_pose(kind: str) -> None:
    world, state = carrier(odometry(), drive=DRIVES[kind], pose=[1.0, 2.0, 0.4], angle_range=[-PI, PI])
    for control in ((0.8, 0.5, 0.3), (0.5, -0.4, -0.6), (-0.3, 0.2, 0.4)):
        drive(world, state, control, 25)
        assert state.readings[:2] == pytest.approx(state.pose[0, :2], abs=1e-9)
        turned = state.readings[2] - state.pose[0, 2]
        assert math.remainder(turned, 2 * PI) == pytest.approx(0.0, abs=1e-9)


def square_errors(clockwise: bool, **errors: Any) -> np.ndarray:
    """True minus believed end of a believed square of 4 m (UMBmark), in the frame of the start."""
    turn = -1 if clockwise else 1
    world, state = carrier(odometry(track=0.5, **errors), dt=0.01)

    def until(index: int, goal: float, control: tuple[float, float]) -> None:
        """Drive until the odometry believes to have come that far."""
        way = 0.0
        while way < goal - 1e-9:
            left = goal - way
            share = min(1.0, left / (abs(control[index]) * 0.01))
            drive(world, state, (control[0] * share, control[1] * share), 1)
            step = state.readings[3] if index == 0 else abs(state.readings[5])
            way += step * 0.01

    for _ in range(4):
        until(0, 4.0, (1.0, 0.0))
        until(1, PI / 2, (0.0, turn * 1.0))
    believed = state.readings[:2]
    return state.pose[0, :2] - believed


def test_umbmark_finds_the_systematic_errors() -> None:
    unequal, track = 0.003, 0.01
    errors = {"diameter_error": unequal, "track_error": track}
    clockwise, counter = square_errors(True, **errors), square_errors(False, **errors)
    found_unequal, found_track = umbmark(clockwise[0], counter[0], length=4.0, track=0.5)
    assert found_unequal == pytest.approx(1 + unequal, abs=2e-3)
    assert found_track == pytest.approx(1 + track, abs=2e-3)


def test_ticks_are_whole_and_pose_follows_from_them() -> None:
    world, state = carrier(odometry(ticks_per_turn=100))
    readings = drive(world, state, (0.37, 0.21), 80)
    assert (readings[:, 6:] == np.round(readings[:, 6:])).all()
    per_tick = 2 * PI * 0.1 / 100
    ways = readings[-1, 6:] * per_tick
    heading = (ways[1] - ways[0]) / 0.4
    assert readings[-1, 2] == pytest.approx(heading, abs=1e-9)
    assert abs(heading - state.pose[0, 2]) <= 2 * per_tick / 0.4


@pytest.mark.parametrize("dt", [0.05, 0.2])
def test_odometry_drifts_with_the_way_whatever_the_step(dt: float) -> None:
    noise = odometry(heading_noise=0.02, distance_noise=0.03)
    world, state = carrier(noise, dt=dt, seeds=range(2000))
    drive(world, state, (1.0, 0.0), round(4.0 / dt))
    readings = state.readings.reshape(2000, 8)
    close = 4 / math.sqrt(2 * 2000)
    assert readings[:, 2].std() == pytest.approx(0.02 * 2.0, rel=close)
    assert abs(readings[:, 2].mean()) < 4 * 0.04 / math.sqrt(2000)
    assert readings[:, 0].std() == pytest.approx(0.03 * 2.0, rel=2 * close)


def test_turns_add_their_own_error() -> None:
    world, state = carrier(odometry(turning_noise=0.05), seeds=range(2000))
    drive(world, state, (0.0, 0.9), 40)
    wrong = np.angle(np.exp(1j * (state.readings.reshape(2000, 8)[:, 2] - state.pose[:, 2])))
    assert wrong.std() == pytest.approx(0.05 * math.sqrt(3.6), rel=4 / math.sqrt(4000))


def test_an_imu_on_a_circle_feels_the_turn_and_the_way_to_the_middle() -> None:
    """Yaw rate w, acceleration w * v towards the middle; ahead of the middle of the body w^2 r more, backwards."""
    for offset, expected in (
        ([0, 0, 0], (0.0, 0.75)),
        ([0.4, 0, 0], (-0.4 * 0.25, 0.75)),
        ([0, 0, PI / 2], (0.75, 0.0)),
    ):
        world, state = carrier(imu(offset=offset), dt=0.01)
        readings = drive(world, state, (1.5, 0.5), 50)[-1]
        assert readings[0] == pytest.approx(0.5, abs=1e-9)
        assert readings[1:] == pytest.approx(expected, abs=1e-4)


def test_an_imu_feels_that_a_robot_sets_off() -> None:
    world, state = carrier(imu(), dt=0.1)
    readings = drive(world, state, (1.0, 0.0), 5)
    assert readings[:, 1] == pytest.approx([10.0, 0, 0, 0, 0], abs=1e-9)


def readings_at_rest(sensor: Any, dt: float, steps: int) -> np.ndarray:
    """(steps, readings) of a carrier that rests."""
    world, state = carrier(sensor, dt=dt)
    out = np.empty((steps, state.readings.size))
    for k in range(steps):
        core.advance(world, state, 1)
        out[k] = state.readings
    return out


@pytest.mark.parametrize("axis", [0, 1])
def test_noise_of_an_imu_is_a_density(axis: int) -> None:
    """One hour at 100 Hz: the Allan deviation at 1 s is the density, and falls with the square root of the time."""
    values = readings_at_rest(imu(gyro_noise=3.4e-4, accel_noise=4e-3), 0.01, 360_000)[:, axis]
    groups = [10, 30, 100, 300, 1000]
    deviation = allan(values, 0.01, groups)
    slope = np.polyfit(np.log(groups), np.log(deviation), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.02)
    assert deviation[2] == pytest.approx((3.4e-4, 4e-3)[axis], rel=0.03)


def test_biases_of_an_imu_are_two_errors() -> None:
    """The offset of an episode stays, while the other one wanders about it with its own time."""
    still = imu(gyro_bias_std=0.01)
    world, state = carrier(still, seeds=range(500))
    first = drive(world, state, (0.0, 0.0), 1).reshape(500, 3)[:, 0]
    later = drive(world, state, (0.0, 0.0), 200)[-1].reshape(500, 3)[:, 0]
    np.testing.assert_array_equal(first, later)
    assert first.std() == pytest.approx(0.01, rel=4 / math.sqrt(1000))
    wandering = imu(gyro_drift_std=0.01, gyro_drift_time=2.0)
    world, state = carrier(wandering, seeds=range(2000))
    begin = drive(world, state, (0.0, 0.0), 1).reshape(2000, 3)[:, 0]
    end = drive(world, state, (0.0, 0.0), 20)[-1].reshape(2000, 3)[:, 0]
    assert begin.std() == pytest.approx(0.01, rel=4 / math.sqrt(4000))
    assert end.std() == pytest.approx(0.01, rel=4 / math.sqrt(4000))
    assert np.corrcoef(begin, end)[0, 1] == pytest.approx(math.exp(-1.0), abs=0.08)


def test_an_imu_rounds_and_clips() -> None:
    world, state = carrier(imu(gyro_resolution=0.1, gyro_range=0.4, gyro_noise=0.02), dt=0.1)
    readings = drive(world, state, (0.0, 0.33), 20)[:, 0]
    assert np.abs(readings * 10 - np.round(readings * 10)).max() < 1e-9
    assert (drive(world, state, (0.0, 0.9), 20)[:, 0] == 0.4).all()


def test_satellite_errors_wander_with_their_time() -> None:
    world, state = carrier(gnss(drift_std=2.0, drift_time=30.0), dt=1.0, seeds=range(400))
    errors = drive(world, state, (0.0, 0.0), 120).reshape(120, 400, 4)[:, :, :2]
    assert errors[0].std() == pytest.approx(2.0, rel=0.1)
    assert errors[-1].std() == pytest.approx(2.0, rel=0.1)
    lag = 30
    kept = float(np.mean(errors[lag:] * errors[:-lag]) / np.mean(errors**2))
    assert -lag / math.log(kept) == pytest.approx(30.0, rel=0.1)


def test_satellite_corrections_come_and_go() -> None:
    world, state = carrier(gnss(rtk=True), dt=1.0, seeds=range(200))
    readings = drive(world, state, (0.0, 0.0), 300).reshape(300, 200, 4)
    settled = readings[100:]
    fixed = settled[..., 2] == 3
    stays = [1 - math.exp(-1 / 20.0), 1 - math.exp(-1 / 5.0)]
    assert fixed.mean() == pytest.approx(stays[1] / sum(stays), abs=0.03)
    assert set(np.unique(settled[..., 2])) == {2.0, 3.0}
    assert settled[fixed][:, 0].std() == pytest.approx(0.01, rel=0.05)
    assert settled[~fixed][:, 0].std() == pytest.approx(0.3, rel=0.05)


def test_zones_block_satellites_and_reflect_them() -> None:
    tunnel, street = polygon((2, -1), (4, -1), (4, 1), (2, 1)), polygon((6, -1), (30, -1), (30, 1), (6, 1))
    sensor = gnss(std=1.0, blocked=[0], reflecting=[1], reflection=4.0)
    world, state = scene(robot(sensors=[sensor], behavior=None), seeds=range(800), mode=1, zones=[tunnel, street])
    spreads = []
    for x in (0.0, 3.0, 8.0):
        state.pose[:, 0] = x
        command(state, *[(0.0, 0.0)] * 800)
        core.advance(world, state, 1)
        spreads.append(state.readings.reshape(800, 4)[:, [0, 2]].copy())
    assert spreads[0][:, 0].std() == pytest.approx(1.0, rel=0.1)
    assert np.isnan(spreads[1][:, 0]).all()
    assert (spreads[1][:, 1] == 0).all()
    assert spreads[2][:, 0].std() == pytest.approx(4.0, rel=0.1)


def test_localization_is_smooth_between_corrections_and_jumps_at_them() -> None:
    world, state = carrier(place(position_std=0.1, heading_std=0.0))
    before, ways = state.readings[:2].copy(), []
    for _ in range(60):
        drive(world, state, (0.5, 0.0), 1)
        ways.append((bool(state.readings[3]), float(np.hypot(*(state.readings[:2] - before)))))
        before = state.readings[:2].copy()
    smooth = [way for corrected, way in ways if not corrected]
    assert smooth == pytest.approx([0.05] * len(smooth), abs=1e-9)
    assert len(smooth) == 48  # a correction every 0.25 m, which are five steps
    assert max(abs(way - 0.05) for corrected, way in ways if corrected) > 0.01


def test_errors_of_localization_have_their_size_and_time() -> None:
    world, state = carrier(place(position_std=0.1, heading_std=0.03, time=3.0), seeds=range(1500))
    drive(world, state, (1.0, 0.0), 30)
    errors = state.readings.reshape(1500, 4)[:, :3] - state.pose
    early = errors.copy()
    assert errors.std(axis=0) == pytest.approx([0.1, 0.1, 0.03], rel=0.07)
    drive(world, state, (1.0, 0.0), 30)
    errors = state.readings.reshape(1500, 4)[:, :3] - state.pose
    assert errors.std(axis=0) == pytest.approx([0.1, 0.1, 0.03], rel=0.07)
    assert np.corrcoef(early[:, 0], errors[:, 0])[0, 1] == pytest.approx(math.exp(-1.0), abs=0.1)


def test_gross_errors_come_by_the_way() -> None:
    world, state = carrier(place(jumps_per_km=100.0, jump_std=5.0, time=0.01), seeds=range(600))
    jumps = 0
    for _ in range(40):
        drive(world, state, (1.0, 0.0), 3)
        errors = np.abs(state.readings.reshape(600, 4)[:, 0] - state.pose[:, 0])
        jumps += int((errors > 0.3).sum())
    assert jumps / 600 == pytest.approx(12 * 0.1 * 0.95, rel=0.15)  # 5 % of the jumps are smaller than 0.3 m


ALL = [odometry(heading_noise=0.02, ticks_per_turn=50), imu(gyro_noise=1e-3, gyro_drift_std=0.01),
       gnss(std=0.5, drift_std=1.0, rtk=False), place(position_std=0.1)]  # fmt: skip


def test_there_is_one_reading_in_each_step() -> None:
    world, state = carrier(*ALL)
    drive(world, state, (1.0, 0.3), 7)
    before = state.readings.copy()
    state.refresh()
    state.refresh()
    np.testing.assert_array_equal(state.readings, before)
    saved = state.save()
    after = drive(world, state, (1.0, 0.3), 5)
    state.load(saved)
    np.testing.assert_array_equal(state.readings, before)
    np.testing.assert_array_equal(drive(world, state, (1.0, 0.3), 5), after)


def test_worlds_of_a_batch_measure_what_they_measure_alone() -> None:
    world, state = carrier(*ALL, seeds=(4, 5, 6))
    together = drive(world, state, (1.0, 0.3), 30).reshape(30, 3, -1)
    for index, seed in enumerate((4, 5, 6)):
        one, alone = carrier(*ALL, seeds=(seed,))
        np.testing.assert_array_equal(drive(one, alone, (1.0, 0.3), 30), together[:, index])


def test_an_episode_starts_anew() -> None:
    world, state = carrier(*ALL)
    first = drive(world, state, (1.0, 0.3), 10)
    state.reset(np.ones(1, np.uint8), False)
    state.reseed(np.zeros(1, np.uint64), np.ones(1, np.uint8))
    again = drive(world, state, (1.0, 0.3), 10)
    assert first[:, 0] == pytest.approx(again[:, 0], abs=0.2)
    assert not np.array_equal(first, again)
