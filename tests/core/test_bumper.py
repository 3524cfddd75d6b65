"""Bumpers: the sectors of a hull that touch something."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from shapely import affinity

import irsim._core as core
from tests.core.worlds import PI, apply, circle, line, obstacle, polygon, rectangle, robot, scene

QUARTERS = [[-PI / 4, PI / 4], [PI / 4, 3 * PI / 4], [3 * PI / 4, 5 * PI / 4], [-3 * PI / 4, -PI / 4]]
"""Front, left, rear, right."""


def bumper(sectors: Any = QUARTERS, reach: float = 0.002) -> core.BumperOptions:
    return core.BumperOptions(sectors=sectors, reach=reach)


def pressed(parts: Any, *things: core.ObjectSpec, sensor: Any = None, pose: Any = (0.0, 0.0, 0.0)) -> list[float]:
    """The readings of a robot with these parts that rests at a pose."""
    sensors = [bumper() if sensor is None else sensor]
    world, state = scene(robot(parts=parts, sensors=sensors, behavior=None, pose=list(pose)), *things, mode=1)
    core.advance(world, state, 1)
    read: list[float] = state.readings.tolist()
    return read


@pytest.mark.parametrize("bearing", np.arange(0.1, 6.28, 0.4))
@pytest.mark.parametrize("turn", [0.0, 2.5])
def test_the_sector_in_which_a_disc_touches_is_pressed(bearing: float, turn: float) -> None:
    for gap, touches in ((0.001, True), (0.004, False)):
        at = (0.5 + gap) * np.array([math.cos(bearing + turn), math.sin(bearing + turn)])
        read = pressed(
            [circle(0.3)], obstacle(parts=[circle(0.2)], pose=[1 + at[0], 2 + at[1], 0.0]), pose=(1.0, 2.0, turn)
        )
        quarter = int(((bearing + PI / 4) % (2 * PI)) // (PI / 2))
        assert read == [float(touches and k == quarter) for k in range(4)]


def test_a_wall_along_one_side_presses_that_side_only() -> None:
    beside = obstacle(parts=[line((-5, 0.251), (5, 0.251))])
    assert pressed([rectangle(1.2, 0.5)], beside, sensor=bumper([[-0.39, 0.39], [0.5, 2.6], [-2.6, -0.5]])) == [0, 1, 0]
    assert pressed([rectangle(1.2, 0.5)], beside) == [1, 1, 1, 0]  # up to 45 degrees the side belongs to front and rear


def test_a_wall_ahead_presses_all_of_the_front() -> None:
    ahead = obstacle(parts=[line((0.601, -5), (0.601, 5))])
    halves = bumper([[-PI / 2, 0.0], [0.0, PI / 2], [PI / 2, 3 * PI / 2]])
    assert pressed([rectangle(1.2, 0.5)], ahead, sensor=halves) == [1, 1, 0]


def test_a_wall_within_the_hull_presses_what_has_passed_it() -> None:
    """A robot that stops at the end of a step has overlapped the wall by then."""
    ahead = obstacle(parts=[line((0.25, -5), (0.25, 5))])
    for parts in ([circle(0.3)], [rectangle(0.6, 0.6)]):
        assert pressed(parts, ahead, sensor=bumper([[-0.3, 0.3], [1.8, 4.4]])) == [1, 0]


def test_what_does_not_obstruct_does_not_press() -> None:
    assert pressed([circle(0.3)], obstacle(parts=[circle(0.2)], pose=[0.4, 0, 0], unobstructed=True)) == [0, 0, 0, 0]


def test_random_bodies_press_as_shapely_says() -> None:
    rng = np.random.default_rng(3)
    hull = [(-0.3, -0.25), (0.5, -0.2), (0.6, 0.1), (0.1, 0.35), (-0.4, 0.2)]
    presses = np.zeros(4)
    for _ in range(300):
        corners = rng.uniform(-0.4, 0.4, (3, 2)) + rng.uniform(-0.9, 0.9, 2)
        other = shapely.Polygon(corners).convex_hull
        body = shapely.Polygon(hull)
        apart = body.distance(other)
        if apart == 0 or other.area < 1e-3:
            continue
        reach = apart + rng.uniform(-0.05, 0.05)
        if reach <= 0 or abs(reach - apart) < 1e-4:
            continue
        expected = []
        for first, last in QUARTERS:
            rays = [(3 * math.cos(a), 3 * math.sin(a)) for a in np.linspace(first, last, 9)]
            part = body.exterior.intersection(shapely.Polygon([(0, 0), *rays]))
            expected.append(float(part.distance(other) <= reach))
        turned = affinity.rotate(other, 0.7, origin=(0, 0), use_radians=True)
        thing = obstacle(parts=[polygon(*np.array(turned.exterior.coords)[:-1].tolist())])
        assert pressed([polygon(*hull)], thing, sensor=bumper(reach=reach), pose=(0, 0, 0.7)) == expected
        presses += expected
    assert presses.min() > 5


@pytest.mark.parametrize("restitution", [0.0, 1.0])
def test_a_push_presses_in_the_step_of_the_contact(restitution: float) -> None:
    mover = robot(parts=[circle(0.2)], sensors=[bumper()], behavior=None, restitution=restitution)
    world, state = scene(mover, obstacle(parts=[line((1, -5), (1, 5))], restitution=restitution), mode=3)
    pressing = []
    for _ in range(12):
        apply(world, state, (1.0, 0.0))
        pressing.append(state.readings.tolist())
        assert bool(state.readings.any()) == bool(state.touching[0] & 1)
    assert pressing[5] == [0, 0, 0, 0]
    assert [1, 0, 0, 0] in pressing
    assert all(read[1:] == [0, 0, 0] for read in pressing)


@pytest.mark.parametrize("mode", [0, 2])
def test_a_robot_that_stops_at_a_wall_is_pressed(mode: int) -> None:
    mover = robot(parts=[circle(0.2)], sensors=[bumper()], behavior=None)
    world, state = scene(mover, obstacle(parts=[line((1, -5), (1, 5))]), mode=mode)
    apply(world, state, (0.3, 0.0), steps=26)
    assert state.readings.tolist() == [0, 0, 0, 0]
    apply(world, state, (0.3, 0.0), steps=4)
    assert state.readings.tolist() == [1, 0, 0, 0]
    assert state.collided[0]


def test_worlds_of_a_batch_feel_what_they_feel_alone() -> None:
    world, state = scene(
        robot(parts=[circle(0.2)], sensors=[bumper()], behavior=None),
        obstacle(parts=[circle(0.2)], pose=[0.401, 0, 0]),
        seeds=(1, 2),
        mode=1,
    )
    state.pose[1] = (0, 0, PI)
    state.pose[2, :2] = (0, 0)
    state.pose[2, 2] = PI
    core.advance(world, state, 1)
    assert state.readings.reshape(2, 4).tolist() == [[1, 0, 0, 0], [0, 0, 1, 0]]
