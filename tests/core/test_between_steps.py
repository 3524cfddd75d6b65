"""Contacts between steps: objects that touch within a step and are apart at both of its ends."""

from __future__ import annotations

import math

import numpy as np
import pytest

import irsim._core as core
from tests.core.worlds import DRIVES, PI, circle, command, line, obstacle, polygon, rectangle, robot, scene

FAST = {"vel_min": [-100.0, -100.0, -100.0], "vel_max": [100.0, 100.0, 100.0], "behavior": None}
OMNI = {**FAST, "drive": DRIVES["omni_angular"]}
BETWEEN = ("contact_between_steps", "passed_through")


def between(state: core.State, world: int = 0) -> list[tuple[str, int, int, int]]:
    """Kind, step and both objects of the contacts between steps."""
    return [(kind, step, i, j) for kind, step, i, j, _, _ in state.events(world) if kind in BETWEEN]


def moment(state: core.State) -> tuple[float, float]:
    """When the only event happened within its step, and how deep the overlap was."""
    assert len(state.events(0)) == 1
    return state.moments(0)[0]


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_a_robot_that_jumps_over_another_passes_through_it(mode: int) -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None), mode=mode)
    command(state, [20.0])
    core.advance(world, state, 1)
    assert between(state) == [("passed_through", 1, 0, 1)]
    when, depth = moment(state)
    assert when == pytest.approx(0.6 / 2.0, abs=1e-8)  # 0.6 m to the contact of a way of 2 m
    assert depth == pytest.approx(0.4, abs=1e-6)
    assert state.events(0)[0][4:] == pytest.approx((0.8, 0.0))
    assert state.between_steps.tolist() == [1, 1]
    assert state.collided.tolist() == state.stopped.tolist() == [0, 0]


def test_a_robot_that_grazes_another_comes_out_on_the_same_side() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.3, 0.0], behavior=None))
    command(state, [20.0])
    core.advance(world, state, 1)
    assert between(state) == [("contact_between_steps", 1, 0, 1)]
    when, depth = moment(state)
    assert when == pytest.approx((1.0 - math.sqrt(0.4**2 - 0.3**2)) / 2.0, abs=1e-8)
    assert depth == pytest.approx(0.1, abs=1e-6)


@pytest.mark.parametrize("gap", [1e-6, -1e-6])
def test_a_micrometre_decides(gap: float) -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.4 + gap, 0.0], behavior=None))
    command(state, [20.0])
    core.advance(world, state, 1)
    assert len(between(state)) == (gap < 0.0)


def test_contacts_at_either_end_are_collisions() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None), mode=1)
    for speed in (8.0, 20.0, -20.0):  # into the other, out of it, through it
        command(state, [speed])
        core.advance(world, state, 1)
    assert [kind for kind, *_ in state.events(0)] == ["collision", "collision"]
    command(state, [-20.0])
    core.advance(world, state, 1)
    assert between(state) == []


def test_unobstructed_things_have_no_contacts_between_steps() -> None:
    for first, second in ((True, False), (False, True)):
        other = robot(pose=[1.0, 0.0, 0.0], behavior=None, unobstructed=second)
        world, state = scene(robot(**FAST, unobstructed=first), other)
        command(state, [20.0])
        core.advance(world, state, 1)
        assert state.events(0) == []
        assert not state.between_steps.any()


WALLS = {
    "rectangle": obstacle(pose=[1.0, 0.0, 0.0], parts=[rectangle(0.02, 4.0)]),
    "line": obstacle(parts=[line((1.0, -2.0), (1.0, 2.0))]),
    "bent": obstacle(parts=[polygon((0.9, -2), (1.1, -2), (1.01, 0), (1.1, 2), (0.9, 2), (0.99, 0))]),
}


@pytest.mark.parametrize("wall", ["rectangle", "line", "bent"])
def test_walls_are_passed_through(wall: str) -> None:
    world, state = scene(robot(**FAST), WALLS[wall])
    command(state, [20.0])
    core.advance(world, state, 1)
    assert between(state) == [("passed_through", 1, 0, 1)]
    near = {"rectangle": 0.99, "line": 1.0, "bent": 0.99}[wall]
    assert moment(state)[0] == pytest.approx((near - 0.2) / 2.0, abs=0.01 if wall == "bent" else 1e-8)


def test_a_turning_bar_hits_what_it_sweeps_over() -> None:
    bar = robot(**OMNI, parts=[rectangle(2.0, 0.02)])
    world, state = scene(bar, obstacle(pose=[0.0, 0.8, 0.0], parts=[circle(0.01)]))
    command(state, [0.0, 0.0, PI / 0.1 * 0.9])
    core.advance(world, state, 1)
    assert between(state) == [("passed_through", 1, 0, 1)]
    early = math.acos((0.01 + 0.01) / 0.8)  # angle at which the side of the bar touches the pole
    assert moment(state)[0] == pytest.approx(early / (0.9 * PI), abs=1e-6)


def test_more_than_half_a_turn_is_known_from_the_yaw_rate() -> None:
    bar = robot(**OMNI, parts=[rectangle(2.0, 0.02)])
    world, state = scene(bar, obstacle(pose=[0.0, -0.8, 0.0], parts=[circle(0.01)]))
    command(state, [0.0, 0.0, PI / 0.1 * 0.4])
    core.advance(world, state, 1)
    assert between(state) == []
    state.reset(np.ones(1, np.uint8), False)
    command(state, [0.0, 0.0, PI / 0.1 * 1.9])
    core.advance(world, state, 1)
    assert between(state) == [("passed_through", 1, 0, 1)]


def test_jumps_are_not_swept() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None))
    state.pose[0, 0] = 2.0
    state.moved(0)
    core.advance(world, state, 1)
    state.pose[0, 0] = 0.0
    core.advance(world, state, 1, external=True)
    command(state, [20.0])
    core.advance(world, state, 1)
    assert [step for _, step, *_ in between(state)] == [3]
    state.reset(np.ones(1, np.uint8), False)
    assert state.events(0) == []
    assert not state.between_steps.any()
    state.refresh()
    assert state.events(0) == []


def test_who_appears_was_not_there_before() -> None:
    world, state = scene(robot(**FAST), robot(pose=[1.0, 0.0, 0.0], behavior=None, appear_step=1))
    command(state, [20.0])
    core.advance(world, state, 1)
    assert state.pose[1, 0] == 1.0
    assert between(state) == []
