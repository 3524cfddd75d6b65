"""`footprint_orca` plans with the limits of its drive: it can always stop where no other object may be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from irsim.scenario.read import or_raise, read
from irsim.simulation.events import BETWEEN_STEPS, read_events
from irsim.simulation.simulation import Simulation
from irsim.testing import simulate

TOP = {
    "diff": ("1, 3", "-1, -3"),
    "omni": ("1, 1", "-1, -1"),
    "omni_angular": ("1, 1, 3", "-1, -1, -3"),
    "acker": ("1, 0.7", "-1, -0.7"),
}


def robot(
    state: Any, goal: Any, *, shape: str, acce: str, drive: str = "diff", velocity: str = "", more: str = ""
) -> str:
    top, low = TOP[drive]
    return f"""
  - kinematics: {{name: {drive}}}
    shape: {shape}
    state: {state}
    {f"velocity: [{velocity}]" if velocity else ""}
    goal: {goal}
    goal_threshold: 0.2
    vel_max: [{top}]
    vel_min: [{low}]
    acce: [{acce}]
    behavior: {{name: footprint_orca{more}}}"""


def world(
    robots: str, *, step: float = 0.1, integration: str = "euler", obstacles: str = "", after: str = "freeze"
) -> str:
    head = f"{{width: 12, height: 12, step_time: {step}, integration: {integration}, after_arrival: {after}}}"
    return f"world: {head}\nrobot:{robots}\n{f'obstacle:{obstacles}' if obstacles else ''}\n"


def run(text: str, seeds: list[int], steps: int, threads: int = 1) -> Simulation:
    simulation = Simulation(or_raise(read(text, strict=True))[0], seeds, threads=threads)
    core.advance(simulation.world, simulation.state, steps, threads=threads)
    return simulation


def touches(simulation: Simulation) -> set[str]:
    kinds = {event.kind for w in range(simulation.copies) for event in read_events(simulation, w)}
    return kinds & {"collision", *BETWEEN_STEPS}


DISC = "{name: circle, radius: 0.3}"
WALL = "\n  - {shape: {name: rectangle, length: 1, width: 10}, state: [%s, 6, 0]}"


def test_it_brakes_when_it_must() -> None:
    """From 1 m/s at 1 m/s^2 and steps of 0.1 s a stop takes 0.09 + 0.08 + ... + 0.01 = 0.45 m."""
    wall = WALL % (6 + 0.3 + 0.4515 + 0.5)
    text = world(robot([6, 6, 0], [11.5, 6], shape=DISC, acce="1, 4", velocity="1, 0"), obstacles=wall)
    simulation, poses = simulate(text, steps=40)
    assert not touches(simulation)
    assert poses[0, 0, 0] == pytest.approx(6.09, abs=1e-9)


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("step", [0.05, 0.1, 0.2, 0.5])
@pytest.mark.parametrize("drive", list(TOP))
def test_a_wall_is_never_hit_however_short_the_horizon(drive: str, step: float, integration: str) -> None:
    acce = {"diff": "0.6, 3", "omni": "0.6, 0.6", "omni_angular": "0.6, 0.6, 3", "acker": "0.6, 2"}[drive]
    shape = "{name: rectangle, length: 0.7, width: 0.4, wheelbase: 0.4}"
    text = world(
        robot([2, 5.7, 0.3], [10, 6], shape=shape, acce=acce, drive=drive, more=", timeHorizonObst: 0.01"),
        step=step,
        integration=integration,
        obstacles=WALL % 7,
    )
    assert not touches(run(text, [0], round(20 / step)))


def test_a_turn_ends_before_its_corner_reaches_a_wall() -> None:
    """At 3 rad/s and 4 rad/s^2 the long body turns by almost 1 rad until it stands."""
    long = "{name: rectangle, length: 1.6, width: 0.2}"
    text = world(
        robot([6, 6, 0], [6, 11], shape=long, acce="1, 4"),
        obstacles="\n  - {shape: {name: rectangle, length: 4, width: 0.2}, state: [6, 5.2, 0.2]}",
    )
    assert not touches(run(text, [0], 200))


@pytest.mark.parametrize("drive", list(TOP))
def test_two_head_on_stop_for_each_other_in_time(drive: str) -> None:
    acce = {"diff": "0.4, 2", "omni": "0.4, 0.4", "omni_angular": "0.4, 0.4, 2", "acker": "0.4, 2"}[drive]
    shape = "{name: rectangle, length: 0.6, width: 0.3, wheelbase: 0.4}"
    pair = robot([1, 6, 0], [11, 6], shape=shape, acce=acce, drive=drive)
    pair += robot([11, 6, math.pi], [1, 6], shape=shape, acce=acce, drive=drive)
    corridor = "".join(
        f"\n  - {{shape: {{name: rectangle, length: 12, width: 1}}, state: [6, {y}, 0]}}" for y in (5.2, 6.8)
    )
    assert not touches(run(world(pair, obstacles=corridor), [0], 250))


CROWD = """
world: {{width: 8, height: 8, step_time: {step}, after_arrival: {after}, integration: {integration}}}
robot:
  - number: {number}
    kinematics: {{name: {drive}}}
    distribution: {{name: random, range_low: [0.5, 0.5, -3.1], range_high: [7.5, 7.5, 3.1], min_distance: 1}}
    shape: {{name: polygon, random_shape: true, is_convex: true, avg_radius_range: [0.1, 0.45],
      irregularity_range: [0, 0.6], num_vertices_range: [3, 7], wheelbase: 0.4}}
    vel_max: [{top}]
    vel_min: [{low}]
    acce: [{acce}]
    goal_threshold: 0.3
    behavior: {{name: footprint_orca, maxNeighbors: {neighbors}}}
obstacle:
  - {{shape: {{name: rectangle, length: 1, width: 0.6}}, state: [4, 4, 0.5]}}
"""


@settings(max_examples=40, deadline=None)
@given(
    drive=st.sampled_from(list(TOP)),
    after=st.sampled_from(["freeze", "yield"]),
    integration=st.sampled_from(["euler", "exact"]),
    step=st.sampled_from([0.05, 0.1, 0.2, 0.4]),
    number=st.integers(2, 14),
    neighbors=st.integers(1, 8),
    acce=st.tuples(*[st.sampled_from([0.2, 0.5, 1.0, 3.0, math.inf])] * 3),
    seed=st.integers(0, 9999),
)
def test_robots_that_run_it_never_touch(
    drive: str,
    after: str,
    integration: str,
    step: float,
    number: int,
    neighbors: int,
    acce: tuple[float, ...],
    seed: int,
) -> None:
    top, low = TOP[drive]
    limits = ", ".join(".inf" if math.isinf(a) else str(a) for a in acce[: len(top.split(","))])
    text = CROWD.format(
        drive=drive,
        after=after,
        integration=integration,
        step=step,
        number=number,
        neighbors=neighbors,
        acce=limits,
        top=top,
        low=low,
    )
    assert not touches(run(text, [seed], round(12 / step)))


def crowd(number: int = 12, drive: str = "diff", acce: str = "1, 4") -> str:
    top, low = TOP[drive]
    return CROWD.format(
        drive=drive,
        after="freeze",
        integration="euler",
        step=0.1,
        number=number,
        neighbors=8,
        acce=acce,
        top=top,
        low=low,
    )


def test_worlds_of_a_batch_are_those_alone_on_any_number_of_threads() -> None:
    alone = [run(crowd(), [seed], 120).pose for seed in range(4)]
    for threads in (1, 3):
        assert np.array_equal(run(crowd(), list(range(4)), 120, threads).pose, np.concatenate(alone))


def test_the_order_of_declaration_does_not_matter() -> None:
    long = "{name: rectangle, length: 0.8, width: 0.3}"
    robots = [
        robot([2, 6, 0], [10, 6.5], shape=long, acce="1, 4"),
        robot([10, 6.2, 3], [2, 6], shape=long, acce="0.5, 2"),
        robot([6, 2, 1.5], [6.2, 10], shape=DISC, acce="1, 4"),
        robot([6, 9, -1.5], [6, 2], shape="{name: rectangle, length: 0.5, width: 0.5}", acce="2, 2"),
    ]
    order = [2, 0, 3, 1]
    _, one = simulate(world("".join(robots)), steps=120)
    _, two = simulate(world("".join(robots[k] for k in order)), steps=120)
    assert abs(one[:, order] - two).max() < 1e-9


def test_deciding_twice_in_a_step_changes_nothing() -> None:
    simulation = run(crowd(), [4], 45)
    core.decide(simulation.world, simulation.state)
    once = simulation.state.command.copy()
    core.decide_row(simulation.world, simulation.state, 2)
    core.decide(simulation.world, simulation.state)
    assert np.array_equal(simulation.state.command, once)
