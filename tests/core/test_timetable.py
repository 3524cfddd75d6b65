"""Rates and latencies of sensors: which step a sensor measures in, and which step shows it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.estimators import allan
from tests.core.test_cones import sonar
from tests.core.test_gauges import ALL, imu, odometry, place
from tests.core.test_perception import detector, mover
from tests.core.worlds import DRIVES, command, fmcw, lidar, obstacle, rectangle, robot, scene

DT = 0.02
SPEED = 1.5
WALL = 15.0


def timed(*times: tuple[float, float]) -> list[core.SensorTiming]:
    return [core.SensorTiming(rate=rate, latency=latency) for rate, latency in times]


def driving(
    *sensors: Any, timing: list[core.SensorTiming], dt: float = DT, seeds: Any = (0,), walls: bool = True
) -> tuple[core.World, core.State]:
    """A robot at x = 0 that may drive to a wall at x = 15 m."""
    fast = {"vel_max": [9.0] * 3, "vel_min": [-9.0] * 3}
    body = robot(sensors=list(sensors), timing=timing, behavior=None, pose=[0.0, 0.0, 0.0], **fast)
    wall = obstacle(parts=[rectangle(0.2, 40.0)], pose=[WALL + 0.1, 0.0, 0.0])
    world, state = scene(body, *([wall] if walls else []), seeds=seeds, mode=1, step_time=dt)
    world.integration = 1
    return world, state


def ahead(**overrides: Any) -> core.Lidar2dOptions:
    """A lidar of one beam straight ahead."""
    return lidar(1, **{"angle_range": 0.0, "range_max": 20.0, **overrides})


def go(world: core.World, state: core.State, steps: int, look: Callable[[], Any], control: Any = (SPEED, 0.0)) -> Any:
    """The data at the start and after each step, while the robots drive."""
    seen = [look()]
    for _ in range(steps):
        command(state, *[control] * world.copies, *[(0.0, 0.0)] * (len(state.pose) - world.copies))
        core.advance(world, state, 1)
        seen.append(look())
    return np.array(seen)


def range_at(time: Any) -> Any:
    return WALL - SPEED * np.asarray(time)


def test_a_lidar_of_10_hz_holds_its_scan_for_five_steps_of_a_world_of_50_hz() -> None:
    world, state = driving(ahead(), timing=timed((10.0, 0.0)))
    seen = go(world, state, 60, lambda: (state.ranges[0], state.stamp[0, 0], state.valid[0]))
    measured = np.arange(61) // 5 * 0.1
    assert seen[:, 1] == pytest.approx(measured, abs=1e-9)
    assert seen[:, 0] == pytest.approx(range_at(measured), abs=1e-9)
    assert seen[:, 2].all()


@pytest.mark.parametrize("rate", [30.0, 49.9, 7.0, 1 / 3, 33.3])
def test_a_rate_that_does_not_divide_does_not_drift(rate: float) -> None:
    """Measurement k is in the first step that ends at k / rate or later, for an hour."""
    world, state = driving(odometry(), timing=timed((rate, 0.0)), walls=False)
    count = 180_000
    stamps = np.empty(count)
    for k in range(count):
        core.advance(world, state, 1)
        stamps[k] = state.stamp[0, 0]
    due = np.arange(math.ceil(count * DT * rate) + 2) / rate
    expected = np.ceil(due / DT - 1e-7)
    moments = np.unique(np.round(stamps / DT))
    np.testing.assert_array_equal(moments, expected[expected <= count])


@pytest.mark.parametrize("rate", [50.0, 77.0, 1e6, 0.0])
def test_a_rate_above_that_of_the_steps_measures_in_each_step(rate: float) -> None:
    world, state = driving(ahead(), timing=timed((rate, 0.0)))
    seen = go(world, state, 20, lambda: (state.ranges[0], state.stamp[0, 0]))
    assert seen[:, 1] == pytest.approx(np.arange(21) * DT, abs=1e-12)
    assert seen[:, 0] == pytest.approx(range_at(seen[:, 1]), abs=1e-9)


@pytest.mark.parametrize(("latency", "steps"), [(0.12, 6), (0.11, 6), (0.101, 6), (0.1, 5), (0.02, 1), (0.001, 1)])
def test_a_latency_shows_what_was_measured_so_long_ago(latency: float, steps: int) -> None:
    world, state = driving(ahead(), timing=timed((0.0, latency)))
    seen = go(world, state, 40, lambda: (state.ranges[0], state.stamp[0, 0], state.valid[0], state.hits[0]))
    nothing, later = seen[:steps], seen[steps:]
    assert (nothing[:, 0] == 20.0).all()
    assert np.isnan(nothing[:, 1]).all()
    assert (nothing[:, 2:] == [0, -1]).all()
    assert later[:, 1] == pytest.approx(np.arange(41 - steps) * DT, abs=1e-12)
    assert later[:, 0] == pytest.approx(range_at(later[:, 1]), abs=1e-9)


def test_rate_and_latency_work_together() -> None:
    """10 Hz and 0.25 s: three scans are on their way at a time."""
    world, state = driving(ahead(), timing=timed((10.0, 0.25)))
    seen = go(world, state, 60, lambda: (state.ranges[0], state.stamp[0, 0]))
    since = np.arange(61) - 13
    measured = since // 5 * 0.1
    assert np.isnan(seen[:13, 1]).all()
    assert seen[13:, 1] == pytest.approx(measured[13:], abs=1e-9)
    assert seen[13:, 0] == pytest.approx(range_at(measured[13:]), abs=1e-9)


def test_a_sonar_between_lidars_keeps_its_own_numbers() -> None:
    """Its rays have no place among the beams that are reported."""
    near = {"range_max": 30.0, "cone": 0.1}
    sensors = [ahead(), sonar(**near), ahead()]
    world, state = driving(*sensors, timing=timed((10.0, 0.04), (25.0, 0.1), (0.0, 0.02)))
    seen = go(world, state, 40, lambda: (*state.ranges, state.readings[0], *state.stamp[0]))
    assert np.isnan(seen[:5, 2]).all()
    assert np.isnan(seen[:5, 5]).all()
    assert (seen[:2, 0] == 20.0).all()
    assert seen[5:, 5] == pytest.approx((np.arange(5, 41) - 5) // 2 * 0.04, abs=1e-9)
    assert seen[5:, 2] == pytest.approx(range_at(seen[5:, 5]), rel=1e-5)
    assert seen[2:, 0] == pytest.approx(range_at(seen[2:, 3]), abs=1e-9)
    assert seen[1:, 1] == pytest.approx(range_at(seen[1:, 4]), abs=1e-9)


NOISY = {"noise": True, "std": 0.1, "angle_std": 0.01}
ERRORS = core.LidarErrors(
    **dict.fromkeys(core.LidarErrors.fields, 0.0)
    | {"dropout": 0.2, "std_per_meter": 0.01, "bias_std": 0.1, "range_dark": math.inf, "incidence_max": math.inf}
    | {"blind": [], "rays": 2, "mixed": "mean", "segments": 4, "beam_time": 1e-4}
)
EVERY = [
    lidar(40, **NOISY, has_velocity=True),
    fmcw(30, **NOISY, velocity_noise_std=0.2),
    lidar(20, realism=ERRORS, **NOISY),
    *ALL,
    detector(probability=0.7, false_tracks=1.0, keep=0.5),
]


def everything(state: core.State) -> np.ndarray:
    return np.concatenate(
        [state.ranges, state.hits, state.valid, state.velocities, state.readings, state.stamp.ravel()]
    )


def test_measurements_are_those_of_a_sensor_that_measures_in_each_step() -> None:
    """Also their noise, to the last bit; only what is a mean since the last reading differs."""
    control = (0.8, 0.5)
    plain = go(*(pair := driving(*EVERY, timing=[])), 60, lambda: everything(pair[1]), control)
    late = go(*(other := driving(*EVERY, timing=timed(*[(12.5, 0.1)] * 8))), 60, lambda: everything(other[1]), control)
    names = other[1].readings.size
    first = late.shape[1] - names - 8
    means = [first + 3, first + 4, first + 5, *range(first + 8, first + 11), *range(first + 18, first + names)]
    same = np.setdiff1d(np.arange(late.shape[1]), means)
    for step in range(5, 61):
        np.testing.assert_array_equal(late[step, same], plain[(step - 5) // 4 * 4, same])
    assert np.isnan(late[4, first:]).all()


def test_speeds_of_odometry_and_imu_are_means_since_the_last_reading() -> None:
    """So they add up to the way and to the turn, however the robot moved in between."""
    world, state = driving(odometry(), imu(), timing=timed((10.0, 0.0), (10.0, 0.06)), walls=False)
    turned, way, speed = 0.0, 0.0, 0.0
    for step in range(1, 61):
        command(state, (1.0 + 0.5 * math.sin(step), 0.7 * math.cos(0.3 * step)))
        core.advance(world, state, 1)
        if step % 5 == 0:
            way += 0.1 * state.readings[3]
            assert 0.1 * state.readings[5] == pytest.approx(state.readings[2] - turned, abs=1e-9)
            turned = state.readings[2]
            assert turned == pytest.approx(state.pose[0, 2], abs=1e-9)
            at_reading = state.readings[2]
        if step % 5 == 3 and step > 5:
            assert 0.1 * state.readings[8] == pytest.approx(at_reading - speed, abs=1e-9)
            speed = at_reading
    expected = sum(0.02 * (1.0 + 0.5 * math.sin(step)) for step in range(1, 61))
    assert way == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(("rate", "axis"), [(25.0, 0), (25.0, 1), (20.0, 0)])
def test_noise_of_a_slow_imu_has_the_density_of_a_fast_one(rate: float, axis: int) -> None:
    """An hour of a world of 100 Hz: the Allan deviation of the readings is the density over the root of the time."""
    sensor = imu(gyro_noise=3.4e-4, accel_noise=4e-3)
    world, state = driving(sensor, timing=timed((rate, 0.0)), dt=0.01, walls=False)
    every = round(100 / rate)
    values = np.empty(360_000 // every)
    for k in range(len(values)):
        core.advance(world, state, every)
        values[k] = state.readings[axis]
    groups = [3, 10, 25, 100, 250]
    deviation = allan(values, 1 / rate, groups)
    slope = np.polyfit(np.log(groups), np.log(deviation), 1)[0]
    assert slope == pytest.approx(-0.5, abs=0.02)
    density = (3.4e-4, 4e-3)[axis]
    assert deviation[1:3] == pytest.approx(density / np.sqrt(np.array(groups[1:3]) / rate), rel=0.03)


def test_noise_of_an_imu_between_the_steps_fits_the_time_since_the_last_reading() -> None:
    """40 Hz in a world of 100 Hz: readings stand for 20 ms or 30 ms."""
    world, state = driving(imu(gyro_noise=0.01), timing=timed((40.0, 0.0)), dt=0.01, walls=False)
    samples: dict[int, list[float]] = {2: [], 3: []}
    before = 0
    for step in range(1, 40_001):
        core.advance(world, state, 1)
        if round(state.stamp[0, 0] * 100) == step:
            samples[step - before].append(state.readings[0])
            before = step
    for steps, values in samples.items():
        assert np.std(values) == pytest.approx(0.01 / math.sqrt(steps * 0.01), rel=4 / math.sqrt(2 * len(values)))


def test_a_correction_between_readings_is_not_lost() -> None:
    world, state = driving(place(min_distance=0.25), timing=timed((5.0, 0.0)), walls=False)
    seen = go(world, state, 200, lambda: (state.readings[3], state.stamp[0, 0]), (1.0, 0.0))
    readings = dict(zip(seen[1:, 1].round(6), seen[1:, 0], strict=True))
    plain, other = driving(place(min_distance=0.25), timing=[], walls=False)
    corrected = go(plain, other, 200, lambda: other.readings[3], (1.0, 0.0))
    for stamp, flag in readings.items():
        until = round(stamp / DT)
        assert flag == corrected[max(0, until - 9) : until + 1].any()


def test_a_detector_looks_at_its_rate() -> None:
    """Half of the people are detected at each look, twice in a second; false tracks are as frequent as ever."""
    sensor = detector(probability=0.5, keep=0.0, max_tracks=2)
    seeds = range(1500)
    carrier = robot(sensors=[sensor], timing=timed((2.0, 0.0)), behavior=None, drive=DRIVES["omni"])
    world, state = scene(carrier, mover(3.0, 0.0), seeds=seeds, mode=1)
    seen = []
    for _ in range(20):
        core.advance(world, state, 1)
        seen.append(np.isfinite(state.readings.reshape(1500, 2, 7)[:, :, 0]).any(axis=1))
    looks = np.array(seen)[4:19].reshape(3, 5, 1500)
    assert (looks == looks[:, :1]).all()
    assert looks[:, 0].mean() == pytest.approx(0.5, abs=4 * 0.5 / math.sqrt(4500))
    false = detector(false_tracks=0.2, keep=100.0, max_tracks=30)
    carrier = robot(sensors=[false], timing=timed((2.0, 0.0)), behavior=None, drive=DRIVES["omni"])
    world, state = scene(carrier, seeds=seeds, mode=1)
    core.advance(world, state, 100)
    begun = np.isfinite(state.readings.reshape(1500, 30, 7)[:, :, 0]).sum(axis=1)
    expected = 20 * (1 - math.exp(-0.1))
    assert begun.mean() == pytest.approx(expected, abs=4 * math.sqrt(expected / 1500))


def test_a_snapshot_holds_what_is_on_its_way() -> None:
    timing = timed(*[(12.5, 0.2), (0.0, 0.1), (20.0, 0.0)] * 2, (5.0, 0.3), (8.0, 0.15))
    world, state = driving(*EVERY, timing=timing)
    go(world, state, 23, lambda: 0, (0.8, 0.5))
    saved, before = state.save(), everything(state)
    after = go(world, state, 40, lambda: everything(state), (0.8, 0.5))
    state.load(saved)
    np.testing.assert_array_equal(everything(state), before)
    np.testing.assert_array_equal(go(world, state, 40, lambda: everything(state), (0.8, 0.5)), after)


@pytest.mark.parametrize("threads", [1, 3])
def test_worlds_of_a_batch_measure_at_the_times_of_a_single_one(threads: int) -> None:
    timing = timed(*[(12.5, 0.2), (0.0, 0.1), (20.0, 0.0)] * 2, (5.0, 0.3), (8.0, 0.15))
    many, states = driving(*EVERY, timing=timing, seeds=(4, 5, 6))
    arrays = ("ranges", "hits", "valid", "velocities", "readings", "stamp")
    core.advance(many, states, 33, threads=threads)
    mask = np.array([0, 1, 0], np.uint8)
    states.reset(mask, True, threads)
    core.advance(many, states, 19, threads=threads)
    for index, seed in enumerate((4, 5, 6)):
        one, alone = driving(*EVERY, timing=timing, seeds=(seed,))
        if index == 1:
            alone.reset(np.ones(1, np.uint8), False)
            core.advance(one, alone, 33)
            alone.reset(np.ones(1, np.uint8), True)
            core.advance(one, alone, 19)
        else:
            core.advance(one, alone, 52)
        for name in arrays:
            of_batch = getattr(states, name).reshape(3, -1)[index]
            np.testing.assert_array_equal(of_batch, getattr(alone, name).ravel(), err_msg=name)


def test_an_episode_shows_nothing_of_the_one_before() -> None:
    world, state = driving(ahead(), odometry(), timing=timed((10.0, 0.1), (0.0, 0.1)))
    go(world, state, 17, lambda: 0)
    state.reset(np.ones(1, np.uint8), False)
    seen = go(world, state, 10, lambda: (state.ranges[0], state.readings[0], *state.stamp[0]))
    assert (seen[:5, 0] == 20.0).all()
    assert np.isnan(seen[:5, 1:]).all()
    assert seen[5:, 2] == pytest.approx([0.0] * 5 + [0.1])
    assert seen[5:, 0] == pytest.approx(range_at(seen[5:, 2]), abs=1e-9)
    assert seen[5:, 1] == pytest.approx(SPEED * seen[5:, 3], abs=1e-9)


def test_a_refresh_measures_again_only_in_the_step_of_a_measurement() -> None:
    world, state = driving(ahead(), timing=timed((10.0, 0.0)))
    go(world, state, 5, lambda: 0)
    state.pose[0, 0] = 3.0
    state.refresh()
    assert state.ranges[0] == pytest.approx(WALL - 3.0)
    command(state, (0.0, 0.0), (0.0, 0.0))
    core.advance(world, state, 1)
    state.pose[0, 0] = 6.0
    state.refresh()
    assert state.ranges[0] == pytest.approx(WALL - 3.0)
    assert state.stamp[0, 0] == pytest.approx(0.1)


def test_a_refresh_replaces_the_measurement_that_is_on_its_way() -> None:
    world, state = driving(ahead(), timing=timed((10.0, 0.04)))
    go(world, state, 5, lambda: 0)
    state.pose[0, 0] = 3.0
    state.refresh()
    seen = go(world, state, 3, lambda: state.ranges[0], (0.0, 0.0))
    assert seen[:2] == pytest.approx(WALL)
    assert seen[2:] == pytest.approx(WALL - 3.0)


def test_noise_of_an_object_scales_slow_readings_too() -> None:
    world, state = driving(imu(gyro_noise=0.01), timing=timed((10.0, 0.1)), seeds=range(2000), walls=False)
    state.noise_scale[:] = np.where(np.arange(2000) < 1000, 1.0, 3.0)
    core.advance(world, state, 40)
    spread = state.readings.reshape(2000, 3)[:, 0].reshape(2, 1000).std(axis=1)
    assert spread == pytest.approx([0.01 / math.sqrt(0.1), 0.03 / math.sqrt(0.1)], rel=4 / math.sqrt(2000))


def test_times_of_the_core_are_checked() -> None:
    with pytest.raises(ValueError, match="one timing for each sensor"):
        driving(ahead(), timing=timed((1.0, 0.0), (1.0, 0.0)))
    for bad in ((-1.0, 0.0), (0.0, -0.1), (0.0, math.nan)):
        with pytest.raises(ValueError, match="must not be negative"):
            driving(ahead(), timing=timed(bad))
