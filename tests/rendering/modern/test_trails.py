"""Trails: where objects have been, in pieces by age, thinned to what can be seen."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from irsim import _core as core
from tests.rendering.modern.conftest import Opened, take

TEXT = """
world: {width: 12, height: 8, step_time: 0.1}
robot:
  - {kinematics: {name: diff}, state: [1, 2, 0], goal: [9, 6, 0], behavior: {name: dash}}
  - {kinematics: {name: omni}, state: [1, 6, 0], goal: [11, 6, 0], behavior: {name: dash}}
"""
AGES = [-1, 60, 30, 10, 5, 0]


def pieces_of(states: np.ndarray, longest: int, least: float) -> list[np.ndarray]:
    """The points of the pieces of a trail."""
    points = states[max(0, len(states) - 1 - longest) if longest >= 0 else 0 :]
    last = len(points) - 1
    borders = [0 if age < 0 else max(0, last - age) for age in AGES]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    kept = np.ones(len(points), bool)
    if least > 0:
        kept = np.diff(along // least, prepend=0.0) != 0
        kept[borders] = True
    return [points[a : b + 1][kept[a : b + 1]] for a, b in itertools.pairwise(borders) if b > a]


@pytest.mark.parametrize("least", [0.0, 0.03, 0.5])
@pytest.mark.parametrize("longest", [-1, 20])
@pytest.mark.parametrize("steps", [0, 1, 2, 8, 75])
def test_a_trail_is_cut_by_age_and_thinned(opened: Opened, steps: int, longest: int, least: float) -> None:
    env = opened(TEXT)
    take(env, steps)
    state = env.simulation.state
    points, ranges = core.trails(state, [0, 1], [0.0, 0.0], AGES, longest, least)
    assert ranges.shape == (2, len(AGES) - 1, 2)
    for row in (0, 1):
        states = np.concatenate([[state.initial_state(row)[:2]], state.trajectory(row)[:, :2]])
        expected = [] if steps == 0 else pieces_of(states, longest, least)
        pieces = [points[a:b] for a, b in ranges[row].tolist() if b > a]
        assert len(pieces) == len(expected)
        for one, other in zip(pieces, expected, strict=True):
            assert np.array_equal(one, other)


def test_a_trail_runs_beside_the_position_by_its_offset(opened: Opened) -> None:
    env = opened(TEXT)
    take(env, 5)
    middle, _ = core.trails(env.simulation.state, [1], [0.0], [-1, 0], -1, 0.0)
    beside, _ = core.trails(env.simulation.state, [1], [0.25], [-1, 0], -1, 0.0)
    assert beside - middle == pytest.approx(np.tile([0.0, 0.25], (6, 1)))


def test_trails_of_unknown_rows_are_refused(opened: Opened) -> None:
    state = opened(TEXT).simulation.state
    for rows, offsets, ages in (([7], [0.0], AGES), ([0], [], AGES), ([0], [0.0], [0])):
        with pytest.raises((ValueError, IndexError)):
            core.trails(state, rows, offsets, ages, -1, 0.0)
