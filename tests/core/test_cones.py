"""Sonars and infrared range sensors against closed forms and statistics."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from tests.core.distributions import assert_share, assert_standard_normal, assert_uniform
from tests.core.worlds import circle, line, obstacle, polygon, robot, scene

CONE: dict[str, Any] = {
    "offset": [0, 0, 0], "range_min": 0.02, "range_max": 4.0, "cone": 0.3, "incidence_max": math.inf, "std": 0.0,
    "std_per_meter": 0.0, "resolution": 0.0, "dropout": 0.0,
}  # fmt: skip
RAY_SPACING = 0.00873


def sonar(**overrides: Any) -> core.SonarOptions:
    return core.SonarOptions(**{**CONE, "crosstalk": 0.0, **overrides})


def infrared(**overrides: Any) -> core.IrRangeOptions:
    return core.IrRangeOptions(**{**CONE, "range_min": 0.1, "range_max": 0.8, "cone": 0.0, "folds": True, **overrides})


def measure(sensor: Any, *things: core.ObjectSpec, seeds: Any = (0,), pose: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
    """The readings after one step, (W, 3), of a sensor on a robot that rests at a pose."""
    carrier = robot(sensors=[sensor], behavior=None, pose=list(pose), parts=[circle(0.05)])
    world, state = scene(carrier, *things, seeds=seeds, mode=1)
    core.advance(world, state, 1)
    assert state.ranges.size == 0
    readings: np.ndarray = state.readings.reshape(len(seeds), 3)
    return readings


def wall(distance: float, slant: float = 0.0, **surface: Any) -> core.ObjectSpec:
    """A long wall that crosses the axis of a sensor in the origin, turned from straight across by an angle."""
    across = 20 * np.array([-math.sin(slant), math.cos(slant)])
    middle = np.array([distance, 0.0])
    return obstacle(parts=[line((middle - across).tolist(), (middle + across).tolist())], **surface)


@pytest.mark.parametrize("slant", [0.0, 0.1, 0.4, 1.0])
def test_a_sonar_reads_the_nearest_point_of_a_wall_in_its_cone(slant: float) -> None:
    """The wall is nearest at the ray closest to its normal: straight at it, or along the edge of the cone."""
    nearest = 2.0 * math.cos(slant) / math.cos(max(0.0, slant - 0.15))
    read = measure(sonar(), wall(2.0, slant))[0]
    assert read.tolist() == pytest.approx([nearest, 1.0, 0.3], rel=RAY_SPACING**2 / 8)


def test_a_sonar_reads_the_nearest_of_what_is_in_its_cone() -> None:
    """A disc that the edge of the cone just meets is nearer than the wall; one outside the cone is not seen."""
    disc = {"parts": [circle(0.1)]}
    bearing = 0.15 + math.asin(0.1 / 1.5)
    inside, outside = bearing - 0.02, bearing + 0.02
    edge = np.array([math.cos(0.15), math.sin(0.15)])
    for angle, seen in ((inside, True), (outside, False)):
        at = 1.5 * np.array([math.cos(angle), math.sin(angle)])
        read = measure(sonar(), wall(2.0), obstacle(pose=[*at.tolist(), 0.0], **disc))[0, 0]
        ahead = float(edge @ at)
        chord = ahead - math.sqrt(max(0.0, 0.01 - (1.5**2 - ahead**2))) if seen else 2.0
        assert read == pytest.approx(chord, abs=1e-9)


def test_a_mounted_sonar_looks_where_its_offset_says() -> None:
    read = measure(sonar(offset=[0.1, 0.2, math.pi / 2]), wall(3.0), pose=(1.0, 0.5, -math.pi / 2))[0, 0]
    assert read == pytest.approx(3.0 - 1.2, rel=1e-5)


def test_without_an_echo_the_greatest_range_is_read_and_not_valid() -> None:
    assert measure(sonar(), wall(4.5))[0].tolist() == [4.0, 0.0, 0.3]
    assert measure(sonar(range_min=0.5), wall(0.3))[0].tolist() == [0.5, 0.0, 0.3]


@pytest.mark.parametrize("over", [-0.01, 0.01])
def test_sound_that_meets_a_slanted_wall_does_not_return(over: float) -> None:
    """Nor does it reach what is behind the wall."""
    slanted = wall(1.0, 0.15 + 0.4 + over)
    read = measure(sonar(incidence_max=0.4), slanted, wall(3.0))[0]
    assert read[1] == (over < 0)
    assert measure(sonar(), slanted, wall(3.0))[0, 1] == 1


@pytest.mark.parametrize("distance", [0.02, 0.05, 0.0999])
def test_a_triangulating_sensor_reads_too_far_when_too_near(distance: float) -> None:
    read, valid, _ = measure(infrared(), wall(distance))[0]
    folded = 0.01 / distance
    assert (read, valid) == pytest.approx((folded, 1) if distance > 0.0125 else (0.8, 0))
    assert read > distance
    assert measure(infrared(folds=False), wall(distance))[0].tolist() == [0.1, 0, 0]


def test_a_triangulating_sensor_is_exact_within_its_range() -> None:
    for distance in (0.1, 0.3, 0.79):
        assert measure(infrared(), wall(distance))[0, :2] == pytest.approx([distance, 1.0])


def test_light_passes_slanted_glass_and_sound_does_not() -> None:
    things = wall(0.3, 0.4, material="glass"), wall(0.6)
    assert measure(infrared(), *things)[0, 0] == pytest.approx(0.6)
    assert measure(sonar(cone=0.0), *things)[0, 0] == pytest.approx(0.3)
    assert measure(infrared(), wall(0.3, material="glass"), wall(0.6))[0, 0] == pytest.approx(0.3)


def test_noise_has_the_spread_that_was_asked_for() -> None:
    count = 20_000
    read = measure(sonar(std=0.01, std_per_meter=0.015), wall(2.0), seeds=range(count))[:, 0]
    assert_standard_normal((read - 2.0) / math.hypot(0.01, 0.03))


def test_noise_grows_with_the_range() -> None:
    at = np.array([0.5, 1.0, 2.0, 3.5])
    spread = [measure(sonar(std_per_meter=0.02), wall(d), seeds=range(20_000))[:, 0].std() for d in at]
    assert np.polyfit(at, spread, 1)[0] == pytest.approx(0.02, rel=0.02)


def test_dropouts_and_other_sonars_come_as_often_as_asked_for() -> None:
    count = 20_000
    lost = measure(sonar(dropout=0.1), wall(2.0), seeds=range(count))
    assert_share(lost[:, 1] == 0, 0.1)
    assert (lost[lost[:, 1] == 0, 0] == 4.0).all()
    heard = measure(sonar(crosstalk=0.2), wall(2.0), seeds=range(count))[:, 0]
    assert_share(heard < 2.0, 0.2 * (2.0 - 0.02) / (4.0 - 0.02))
    assert_uniform(heard[heard < 2.0], 0.02, 2.0)
    assert_share(measure(sonar(crosstalk=0.2), seeds=range(count))[:, 1], 0.2)


def test_ranges_are_rounded() -> None:
    assert measure(sonar(resolution=0.03), wall(2.0))[0, 0] == pytest.approx(2.01)


def test_worlds_of_a_batch_measure_what_they_measure_alone() -> None:
    sensor, box = sonar(std=0.02, dropout=0.1, crosstalk=0.1), obstacle(
        parts=[polygon((0, 0), (1, 0), (1, 1), (0, 1))], pose=[1.0, -0.5, 0.2]
    )  # fmt: skip
    together = measure(sensor, box, seeds=(4, 5, 6, 7))
    alone = [measure(sensor, box, seeds=(seed,))[0] for seed in (4, 5, 6, 7)]
    np.testing.assert_array_equal(together, alone)
    assert len(np.unique(together[:, 0])) > 1


def test_each_step_draws_anew() -> None:
    carrier = robot(sensors=[sonar(std=0.02)], behavior=None)
    world, state = scene(carrier, wall(2.0), mode=1)
    read = []
    for _ in range(5):
        core.advance(world, state, 1)
        read.append(float(state.readings[0]))
        state.refresh()
        assert state.readings[0] == read[-1]
    assert len(set(read)) == 5
