"""`footprint_orca`: robots pass by their true outlines, walk round what stands, get out of jams, and never touch."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import irsim._core as core
from irsim.benchmarks.suite_plan import suite_plan
from irsim.scenario.read import or_raise, read
from irsim.simulation.events import read_events
from irsim.simulation.simulation import Simulation
from irsim.testing import simulate
from irsim.testing.conformance import simulated_drives
from tests.core.worlds import assert_identical, everything

SUITE = "random_polygons_v1"
LONG = "{name: rectangle, length: 0.8, width: 0.3}"


def entry(state: Any, goal: Any, *, behavior: str = "footprint_orca", shape: str = LONG, more: str = "") -> str:
    return (
        f"  - {{kinematics: {{name: diff}}, shape: {shape}, state: {state}, goal: {goal}, goal_threshold: 0.2,"
        f" behavior: {{name: {behavior}}}, vel_max: [1, 3], vel_min: [-1, -3]{more}}}\n"
    )


def world(*robots: str, after: str = "yield", obstacles: str = "") -> str:
    return f"world: {{width: 12, height: 12, after_arrival: {after}}}\nrobot:\n{''.join(robots)}{obstacles}"


def run(text: str, seeds: list[int], steps: int = 400, threads: int = 1) -> Simulation:
    simulation = Simulation(or_raise(read(text, strict=True))[0], seeds, threads=threads)
    core.advance(simulation.world, simulation.state, steps, threads=threads)
    return simulation


def crowd(robots: int, after: str) -> str:
    """A scene of the suite that the behavior is made for."""
    (one,) = suite_plan(SUITE, policies=["dash"], scenarios=[f"robots-{robots}"], protocols=[after]).scenarios
    return one.text.replace("  kinematics:", "  behavior: {name: footprint_orca}\n  kinematics:", 1)


def outcome(simulation: Simulation) -> tuple[bool, bool]:
    """Whether all robots have arrived, and whether any two ever touched."""
    kinds = [event.kind for w in range(simulation.copies) for event in read_events(simulation, w)]
    return bool(simulation.arrived[np.tile(simulation.robots, simulation.copies)].all()), "collision" in kinds


def test_two_head_on_pass_each_other() -> None:
    text = world(entry([2, 6, 0], [10, 6]), entry([10, 6, 3.14159], [2, 6]))
    assert outcome(run(text, [0], 150)) == (True, False)


def test_a_ring_swaps_places() -> None:
    robots = []
    for k in range(8):
        x, y, heading = 4 * math.cos(k * math.pi / 4), 4 * math.sin(k * math.pi / 4), (k + 4) * math.pi / 4
        robots.append(entry([6 + x, 6 + y, heading], [6 - x, 6 - y]))
    assert outcome(run(world(*robots), [0], 400)) == (True, False)


@pytest.mark.parametrize(("behavior", "arrives"), [("orca", False), ("footprint_orca", True)])
def test_a_gap_as_wide_as_the_true_outline_is_open(behavior: str, arrives: bool) -> None:
    """A robot 0.3 m wide passes 0.4 m between two walls; the circle round it has a diameter of 0.85 m."""
    walls = "obstacle:\n" + "".join(
        f"  - {{shape: {{name: rectangle, length: 0.4, width: 6}}, state: [6, {y}, 0]}}\n" for y in (2.8, 9.2)
    )
    text = world(entry([3, 6.05, 0], [9, 6], behavior=behavior), obstacles=walls)
    assert outcome(run(text, [0], 150)) == (arrives, False)


@pytest.mark.parametrize(("behavior", "arrives"), [("orca", False), ("footprint_orca", True)])
def test_a_way_leads_round_robots_that_have_arrived(behavior: str, arrives: bool) -> None:
    """Five robots that stay where they are make a pocket in front of the goal."""
    places = [[7, 6], [6.7, 6.7], [6.7, 5.3], [6.1, 7.0], [6.1, 5.0]]
    pocket = [entry([x - 0.1, y, 0], [x, y], shape="{name: circle, radius: 0.3}") for x, y in places]
    text = world(
        *pocket, entry([2, 6, 0], [10, 6], behavior=behavior, shape="{name: circle, radius: 0.3}"), after="freeze"
    )
    simulation = run(text, [0], 300)
    assert outcome(simulation) == (arrives, False)


def test_an_arrived_robot_makes_room_and_comes_back() -> None:
    """A corridor is too narrow for two. The one that has arrived in it leaves it, and returns."""
    walls = "obstacle:\n" + "".join(
        f"  - {{shape: {{name: rectangle, length: 4, width: 20}}, state: [6, {y}, 0]}}\n" for y in (-4.6, 16.6)
    )
    small = "{name: circle, radius: 0.3}"
    text = world(
        entry([7.5, 6, 3.14], [7.4, 6], shape=small), entry([2, 6, 0], [10.5, 6], shape=small), obstacles=walls
    )
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


def test_it_makes_way_for_one_that_does_not() -> None:
    text = world(entry([2, 6, 0], [10, 6]), entry([10, 6.1, 3.14159], [2, 6.1], behavior="dash"))
    assert outcome(run(text, [0], 150)) == (True, False)


def test_without_backward_it_turns_round() -> None:
    slow = {}
    for backward in ("true", "false"):
        behavior = f"footprint_orca, backward: {backward}"
        simulation, poses = simulate(world(entry([6, 6, 0], [3, 6], behavior=behavior)), steps=60)
        assert simulation.arrived[0]
        slow[backward] = int((np.abs(poses[:, 0, 0] - 3) > 0.2).sum())
        assert (abs(poses[-1, 0, 2]) < 1) == (backward == "true"), "it ends as it has driven"
    assert slow["false"] > slow["true"] + 5


def test_worlds_of_a_batch_are_those_alone_on_any_number_of_threads() -> None:
    text = crowd(10, "freeze")
    alone = [run(text, [seed], 120).pose for seed in range(4)]
    for threads in (1, 3):
        assert np.array_equal(run(text, list(range(4)), 120, threads).pose, np.concatenate(alone))


def test_the_order_of_declaration_does_not_matter() -> None:
    robots = [
        entry([2, 6, 0], [10, 6.5]),
        entry([10, 6.2, 3], [2, 6]),
        entry([6, 2, 1.5], [6.2, 10], shape="{name: circle, radius: 0.3}"),
        entry([6, 9, -1.5], [6, 2], shape="{name: rectangle, length: 0.5, width: 0.5}"),
    ]
    order = [2, 0, 3, 1]
    _, one = simulate(world(*robots), steps=120)
    _, two = simulate(world(*(robots[k] for k in order)), steps=120)
    assert abs(one[:, order] - two).max() < 1e-9


def test_a_reset_forgets_the_way() -> None:
    simulation = run(crowd(10, "freeze"), [7], 60)
    first = simulation.pose.copy()
    simulation.state.reseed(np.array([7], dtype=np.uint64), np.ones(1, dtype=np.uint8))
    simulation.state.reset(np.ones(1, dtype=np.uint8), False)
    core.advance(simulation.world, simulation.state, 60)
    assert np.array_equal(simulation.pose, first)


def test_deciding_twice_in_a_step_changes_nothing() -> None:
    simulation = run(crowd(15, "freeze"), [4], 45)
    core.decide(simulation.world, simulation.state)
    once = everything(simulation.state)
    core.decide_row(simulation.world, simulation.state, 2)
    core.decide(simulation.world, simulation.state)
    assert_identical(everything(simulation.state), once)


def wall(low: float, high: float) -> str:
    return f"obstacle:\n  - {{shape: {{name: linestring, vertices: [[6, {low}], [6, {high}]]}}}}\n"


def test_a_body_of_parts_is_known_as_a_whole() -> None:
    body = f"{{name: compound, parts: [{LONG}, {{name: circle, radius: 0.3, pose: [0.4, 0, 0]}}]}}"
    simulation = run(world(entry([2, 6, 0], [10, 6], shape=body), obstacles=wall(0, 12)), [0], 100)
    assert outcome(simulation) == (False, False), "its nose is seen, so it stops before the wall"


@pytest.mark.parametrize("shape", [LONG, "{name: circle, radius: 0.3}"])
def test_a_single_long_wall_is_gone_round(shape: str) -> None:
    simulation = run(world(entry([2, 6, 0], [10, 6], shape=shape), obstacles=wall(4, 8)), [0], 150)
    assert outcome(simulation) == (True, False)
