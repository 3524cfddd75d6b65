"""`footprint_orca`: robots pass by their true outlines and within the limits of their drives, and never touch."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import irsim._core as core
from irsim.benchmarks.suite_plan import suite_plan
from irsim.scenario.read import or_raise, read
from irsim.simulation.events import BETWEEN_STEPS, read_events
from irsim.simulation.simulation import Simulation
from irsim.testing import simulate
from irsim.testing.conformance import simulated_drives

SUITE = "random_polygons_v1"
LONG = "{name: rectangle, length: 0.8, width: 0.3}"


DISC = "{name: circle, radius: 0.3}"
TOP = {
    "diff": ("1, 3", "-1, -3"),
    "omni": ("1, 1", "-1, -1"),
    "omni_angular": ("1, 1, 3", "-1, -1, -3"),
    "acker": ("1, 0.7", "-1, -0.7"),
}


def entry(
    state: Any,
    goal: Any,
    *,
    behavior: str = "footprint_orca",
    shape: str = LONG,
    drive: str = "diff",
    acce: str = "",
    more: str = "",
) -> str:
    top, low = TOP[drive]
    limits = f", acce: [{acce}]" if acce else ""
    return (
        f"  - {{kinematics: {{name: {drive}}}, shape: {shape}, state: {state}, goal: {goal}, goal_threshold: 0.2,"
        f" behavior: {{name: {behavior}}}, vel_max: [{top}], vel_min: [{low}]{limits}{more}}}\n"
    )


def boxes(*placed: tuple[float, float, float, float, float]) -> str:
    """Boxes of a length and width, at x, y and heading."""
    lines = [
        f"  - {{shape: {{name: rectangle, length: {a}, width: {b}}}, state: [{x}, {y}, {turn}]}}\n"
        for a, b, x, y, turn in placed
    ]
    return "".join(["obstacle:\n", *lines])


def world(*robots: str, after: str = "yield", obstacles: str = "", more: str = "") -> str:
    return f"world: {{width: 12, height: 12, after_arrival: {after}{more}}}\nrobot:\n{''.join(robots)}{obstacles}"


def run(text: str, seeds: Sequence[int] = (0,), steps: int = 400, threads: int = 1) -> Simulation:
    simulation = Simulation(or_raise(read(text, strict=True))[0], seeds, threads=threads)
    core.advance(simulation.world, simulation.state, steps, threads=threads)
    return simulation


def crowd(robots: int, after: str) -> str:
    """A scene of the suite that the behavior is made for."""
    (one,) = suite_plan(SUITE, policies=["dash"], scenarios=[f"robots-{robots}"], protocols=[after]).scenarios
    return one.text.replace("  kinematics:", "  behavior: {name: footprint_orca}\n  kinematics:", 1)


def touches(simulation: Simulation) -> set[str]:
    kinds = {event.kind for w in range(simulation.copies) for event in read_events(simulation, w)}
    return kinds & {"collision", *BETWEEN_STEPS}


def outcome(simulation: Simulation) -> tuple[bool, bool]:
    """Whether all robots have arrived, and whether any two ever touched."""
    arrived = simulation.arrived[np.tile(simulation.robots, simulation.copies)]
    return bool(arrived.all()), "collision" in touches(simulation)


@pytest.mark.parametrize("other", ["footprint_orca", "dash"])
def test_two_head_on_pass_and_one_makes_way_for_one_that_does_not(other: str) -> None:
    text = world(entry([2, 6, 0], [10, 6]), entry([10, 6.1, 3.14159], [2, 6.1], behavior=other))
    assert outcome(run(text, steps=150)) == (True, False)


def test_a_ring_swaps_places() -> None:
    robots = []
    for k in range(8):
        x, y, heading = 4 * math.cos(k * math.pi / 4), 4 * math.sin(k * math.pi / 4), (k + 4) * math.pi / 4
        robots.append(entry([6 + x, 6 + y, heading], [6 - x, 6 - y]))
    assert outcome(run(world(*robots))) == (True, False)


@pytest.mark.parametrize(("behavior", "arrives"), [("orca", False), ("footprint_orca", True)])
def test_a_gap_as_wide_as_the_true_outline_is_open(behavior: str, arrives: bool) -> None:
    """A robot 0.3 m wide passes 0.4 m between two walls; the circle round it has a diameter of 0.85 m."""
    walls = boxes((0.4, 6, 6, 2.8, 0), (0.4, 6, 6, 9.2, 0))
    text = world(entry([3, 6.05, 0], [9, 6], behavior=behavior), obstacles=walls)
    assert outcome(run(text, steps=150)) == (arrives, False)


@pytest.mark.parametrize(("behavior", "arrives"), [("orca", False), ("footprint_orca", True)])
def test_a_way_leads_round_robots_that_have_arrived(behavior: str, arrives: bool) -> None:
    """Five robots that stay where they are make a pocket in front of the goal."""
    places = [[7, 6], [6.7, 6.7], [6.7, 5.3], [6.1, 7.0], [6.1, 5.0]]
    pocket = [entry([x - 0.1, y, 0], [x, y], shape=DISC) for x, y in places]
    text = world(*pocket, entry([2, 6, 0], [10, 6], behavior=behavior, shape=DISC), after="freeze")
    assert outcome(run(text, steps=300)) == (arrives, False)


def test_an_arrived_robot_makes_room_and_comes_back() -> None:
    """A corridor is too narrow for two. The one that has arrived in it leaves it, and returns."""
    walls = boxes((4, 20, 6, -4.6, 0), (4, 20, 6, 16.6, 0))
    pair = entry([7.5, 6, 3.14], [7.4, 6], shape=DISC), entry([2, 6, 0], [10.5, 6], shape=DISC)
    text = world(*pair, obstacles=walls)
    simulation, poses = simulate(text, steps=400)
    assert simulation.arrived[:2].all()
    assert not outcome(simulation)[1]
    away = np.hypot(*(poses[:, 0, :2] - [7.4, 6]).T)
    assert away.max() > 0.5
    assert away[-1] < 0.25, "it comes back"


@pytest.mark.parametrize("drive", simulated_drives())
def test_every_drive_arrives_in_a_crowd(drive: str) -> None:
    top, low = ("1, 1, 1", "-1, -1, -1") if drive == "omni_angular" else ("1, 0.7", "-1, -0.7")
    text = f"""
world: {{width: 10, height: 10, after_arrival: freeze}}
robot:
  - number: 6
    kinematics: {{name: {drive}}}
    shape: {{name: rectangle, length: 0.6, width: 0.3, wheelbase: 0.4}}
    distribution: {{name: random, range_low: [1, 1, -3], range_high: [9, 9, 3], min_distance: 1.2}}
    goal_threshold: 0.3
    vel_max: [{top}]
    vel_min: [{low}]
    behavior: {{name: footprint_orca}}
"""
    assert outcome(run(text, list(range(5)), 500)) == (True, False)


@pytest.mark.parametrize("after", ["freeze", "yield"])
def test_robots_never_touch_in_random_scenes(after: str) -> None:
    simulation = run(crowd(15, after), list(range(500, 520)), 500, threads=2)
    arrived, touched = outcome(simulation)
    assert not touched
    assert simulation.arrived.mean() > 0.99
    assert arrived or after == "freeze", "robots that stay for good may block others"


def test_without_backward_it_turns_round() -> None:
    slow = {}
    for backward in ("true", "false"):
        behavior = f"footprint_orca, backward: {backward}"
        simulation, poses = simulate(world(entry([6, 6, 0], [3, 6], behavior=behavior)), steps=60)
        assert simulation.arrived[0]
        slow[backward] = int((np.abs(poses[:, 0, 0] - 3) > 0.2).sum())
        assert (abs(poses[-1, 0, 2]) < 1) == (backward == "true"), "it ends as it has driven"
    assert slow["false"] > slow["true"] + 5


def line(low: float, high: float) -> str:
    return f"obstacle:\n  - {{shape: {{name: linestring, vertices: [[6, {low}], [6, {high}]]}}}}\n"


def test_a_body_of_parts_is_known_as_a_whole() -> None:
    body = f"{{name: compound, parts: [{LONG}, {{name: circle, radius: 0.3, pose: [0.4, 0, 0]}}]}}"
    simulation = run(world(entry([2, 6, 0], [10, 6], shape=body), obstacles=line(0, 12)), steps=100)
    assert outcome(simulation) == (False, False), "its nose is seen, so it stops before the wall"


@pytest.mark.parametrize("shape", [LONG, DISC])
def test_a_single_long_wall_is_gone_round(shape: str) -> None:
    simulation = run(world(entry([2, 6, 0], [10, 6], shape=shape), obstacles=line(4, 8)), steps=150)
    assert outcome(simulation) == (True, False)


# limits of drives -----------------------------------------------------------------------------------------------------
SLOW = {"diff": "0.6, 3", "omni": "0.6, 0.6", "omni_angular": "0.6, 0.6, 3", "acker": "0.6, 2"}
CAR = "{name: rectangle, length: 0.7, width: 0.4, wheelbase: 0.4}"


def test_it_brakes_when_it_must() -> None:
    """From 1 m/s at 1 m/s^2 and steps of 0.1 s a stop takes 0.09 + 0.08 + ... + 0.01 = 0.45 m."""
    wall = boxes((1, 10, 6 + 0.3 + 0.4515 + 0.5, 6, 0))
    start = entry([6, 6, 0], [11.5, 6], shape=DISC, acce="1, 4", more=", velocity: [1, 0]")
    simulation, poses = simulate(world(start, obstacles=wall, after="freeze"), steps=40)
    assert not touches(simulation)
    assert poses[0, 0, 0] == pytest.approx(6.09, abs=1e-9)


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("step", [0.05, 0.1, 0.2, 0.5])
@pytest.mark.parametrize("drive", TOP)
def test_a_wall_is_never_hit_however_short_the_horizon(drive: str, step: float, integration: str) -> None:
    behavior = "footprint_orca, timeHorizonObst: 0.01"
    start = entry([2, 5.7, 0.3], [10, 6], shape=CAR, acce=SLOW[drive], drive=drive, behavior=behavior)
    more = f", step_time: {step}, integration: {integration}"
    assert not touches(run(world(start, obstacles=boxes((1, 10, 7, 6, 0)), more=more), steps=round(20 / step)))


def test_a_turn_ends_before_its_corner_reaches_a_wall() -> None:
    """At 3 rad/s and 4 rad/s^2 the long body turns by almost 1 rad until it stands."""
    start = entry([6, 6, 0], [6, 11], shape="{name: rectangle, length: 1.6, width: 0.2}", acce="1, 4")
    assert not touches(run(world(start, obstacles=boxes((4, 0.2, 6, 5.2, 0.2))), steps=200))


@pytest.mark.parametrize("drive", TOP)
def test_two_head_on_stop_for_each_other_in_time(drive: str) -> None:
    ends = (([1, 6, 0], [11, 6]), ([11, 6, math.pi], [1, 6]))
    pair = [entry(start, goal, shape=CAR, acce=SLOW[drive], drive=drive) for start, goal in ends]
    corridor = boxes((12, 1, 6, 5.15, 0), (12, 1, 6, 6.85, 0))
    assert not touches(run(world(*pair, obstacles=corridor), steps=250))


def test_the_order_of_declaration_does_not_matter() -> None:
    robots = [
        entry([2, 6, 0], [10, 6.5], acce="1, 4"),
        entry([10, 6.2, 3], [2, 6], acce="0.5, 2"),
        entry([6, 2, 1.5], [6.2, 10], shape=DISC, acce="1, 4"),
        entry([6, 9, -1.5], [6, 2], shape="{name: rectangle, length: 0.5, width: 0.5}", acce="2, 2"),
    ]
    order = [2, 0, 3, 1]
    one, two = (simulate(world(*chosen), steps=120)[1] for chosen in (robots, [robots[k] for k in order]))
    assert abs(one[:, order] - two).max() < 1e-9


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
    acce=st.tuples(*[st.sampled_from([0.2, 0.5, 1.0, 3.0, math.inf])] * 3),
    seed=st.integers(0, 9999),
    options=st.fixed_dictionaries(
        {
            "after": st.sampled_from(["freeze", "yield"]),
            "integration": st.sampled_from(["euler", "exact"]),
            "step": st.sampled_from([0.05, 0.1, 0.2, 0.4]),
            "number": st.integers(2, 14),
            "neighbors": st.integers(1, 8),
        }
    ),
)
def test_robots_that_run_it_never_touch(
    drive: str, acce: tuple[float, ...], seed: int, options: dict[str, Any]
) -> None:
    top, low = TOP[drive]
    limits = ", ".join(".inf" if math.isinf(a) else str(a) for a in acce[: len(top.split(","))])
    text = CROWD.format(drive=drive, top=top, low=low, acce=limits, **options)
    assert not touches(run(text, [seed], round(12 / options["step"])))
