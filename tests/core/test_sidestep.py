"""Passing others: a preference for one side, and gaps that are kept, so that robots never touch."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

import irsim
from irsim.api import read_scenario
from tests.core.worlds import assert_success, collisions
from tests.parity.avoidance.judge import at_ends, within_steps

LOCALS = {
    "orca": "name: orca, timeHorizon: 3",
    "rvo": "name: rvo, vxmax: 1.2, vymax: 1.2",
    "sfm": "name: sfm, vmax: 1.0, safety_radius: 0.1",
}


def world(behavior: str, *robots: tuple[Sequence[float], Sequence[float], float]) -> str:
    entries = "".join(
        f"  - {{kinematics: {{name: omni}}, shape: {{name: circle, radius: 0.25}}, state: {state}, goal: {goal}, "
        f"goal_threshold: 0.2, vel_max: [{top}, {top}], vel_min: [{-top}, {-top}], behavior: {{{behavior}}}}}\n"
        for state, goal, top in robots
    )
    return f"world: {{width: 20, height: 10, time_limit: 30}}\nrobot:\n{entries}"


def head_on(behavior: str) -> str:
    return world(behavior, ([1, 5, 0], [12, 5], 1.0), ([12, 5, math.pi], [1, 5], 1.0))


@pytest.mark.parametrize("name", LOCALS)
def test_two_that_meet_head_on_pass_on_the_right(name: str) -> None:
    result = assert_success(head_on(f"{LOCALS[name]}, sidestep: 10"), seed=0)
    assert max(robot.time_to_goal or math.inf for robot in result.robots) < 12
    without = irsim.run(text=head_on(f"{LOCALS[name]}, sidestep: 0"), seed=0)
    assert without.outcome != "success"


@pytest.mark.parametrize("name", LOCALS)
def test_a_faster_one_passes_a_slower_one_straight_ahead(name: str) -> None:
    robots = ([3, 5, 0], [19, 5], 0.4), ([1, 5, 0], [18, 5], 1.2)
    result = irsim.run(text=world(f"{LOCALS[name]}, sidestep: 10", *robots), seed=0)
    behind = result.robots[1]
    assert (behind.time_to_goal or math.inf) < 18
    assert collisions(result) == []


def test_the_sign_chooses_the_side() -> None:
    for angle, side in ((10, -1), (-10, 1)):  # east-bound: the right is towards smaller y
        text = world(f"name: orca, timeHorizon: 3, sidestep: {angle}", ([1, 5, 0], [12, 5], 1.0),
                     ([12, 5, math.pi], [1, 5], 1.0))  # fmt: skip
        result = irsim.run(text=text, seed=0, steps=50)
        assert math.copysign(1, result.robots[0].pose[1] - 5) == side


def test_alone_it_drives_straight() -> None:
    text = world("name: orca, sidestep: 20", ([1, 5, 0], [12, 5], 1.0))
    assert irsim.run(text=text, seed=0, steps=40).robots[0].pose[1] == 5


RING = """
world: {{width: 12, height: 12, time_limit: 90}}
robot:
  - number: {count}
    kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.25}}
    distribution: {{name: circle, center: [6, 6], radius: 4}}
    goal_threshold: 0.2
    vel_max: [1, {turn}]
    vel_min: [-1, -{turn}]
    behavior: {{{behavior}}}
"""


@pytest.mark.parametrize("count", [3, 4, 5, 6, 7, 8])
@pytest.mark.parametrize("behavior", ["name: orca", *LOCALS.values()])
@pytest.mark.parametrize(("drive", "turn"), [("omni", 1), ("diff", 2)])
def test_a_ring_opens(behavior: str, count: int, drive: str, turn: float) -> None:
    text = RING.format(count=count, drive=drive, turn=turn, behavior=f"{behavior}, sidestep: 10")
    assert_success(text, seed=0)


CROWD = """
world: {{width: 6, height: 6, step_time: {dt}, integration: {integration}, collision_mode: unobstructed}}
robot:
  - number: 12
    distribution: {{name: random, range_low: [0.5, 0.5, -3.14], range_high: [5.5, 5.5, 3.14]}}
    kinematics: {{name: {drive}}}
    shape: {{name: circle, radius: 0.2}}
    behavior: {{name: {law}, loop: true}}
"""
PAIR = """
world: {{width: 10, height: 4, step_time: 0.1}}
{role}:
  - kinematics: {{name: omni}}
    shape: {{name: circle, radius: 0.2}}
    state: [[1, 2, 0], [9, 2.1, 0]]
    goal: [[9, 2], [1, 2.1]]
    number: 2
    distribution: {{name: manual}}
    behavior: {{name: sfm, force_factor_social: 0, {more}}}
"""


def gaps(text: str, seed: int, steps: int, count: int) -> tuple[float, float]:
    """The least gap at the ends of steps, and within them [m]."""
    batch = irsim.batch(read_scenario(text=text, strict=False)[0], 1, seeds=[seed])
    path = [batch.pose[0, :count, :2].copy()]
    for _ in range(steps):
        batch.step()
        path.append(batch.pose[0, :count, :2].copy())
    places = np.array(path)
    return float(at_ends(places, [], 0.2).min()), float(within_steps(places, [], 0.2).min())


@pytest.mark.parametrize("integration", ["euler", "exact"])
@pytest.mark.parametrize("dt", [0.05, 0.2, 0.5])
@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
@pytest.mark.parametrize("law", ["rvo", "sfm"])
def test_robots_in_a_crowd_never_touch(law: str, drive: str, dt: float, integration: str) -> None:
    text = CROWD.format(law=law, drive=drive, dt=dt, integration=integration)
    for seed in range(3):
        ends, within = gaps(text, seed, round(20 / dt), 12)
        assert ends > 0
        assert within > (0 if integration == "euler" else -1e-3)


def test_people_and_robots_that_say_so_go_on_as_in_2_12() -> None:
    apart = {more: gaps(PAIR.format(role="robot", more=more), 0, 80, 2)[0] for more in ("", "keep_gap: false")}
    people = gaps(PAIR.format(role="obstacle", more=""), 0, 80, 2)[0]
    assert apart[""] > 0 > apart["keep_gap: false"]
    assert people == pytest.approx(apart["keep_gap: false"])
    assert gaps(PAIR.format(role="obstacle", more="keep_gap: true"), 0, 80, 2)[0] == pytest.approx(apart[""])


@pytest.mark.parametrize(("radius", "count"), [(0.3, 2), (0.3, 5), (0.2, 8)])
def test_wheels_turn_until_they_roll_along_what_is_in_the_way(radius: float, count: int) -> None:
    """Two whose headings were within the dead band of turns stood before each other for ever."""
    text = (
        f"world: {{width: 20, height: 20, time_limit: 60}}\nrobot:\n  - number: {count}\n"
        "    distribution: {name: circle, center: [10, 10], radius: 6}\n"
        f"    kinematics: {{name: diff}}\n    shape: {{name: circle, radius: {radius}}}\n    goal_threshold: 0.2\n"
        "    behavior: {name: sfm}\n"
    )
    assert irsim.run(text=text, seed=0).outcome == "success"


def test_those_that_are_held_up_slide_past() -> None:
    batch = irsim.batch(read_scenario(text=PAIR.format(role="robot", more=""), strict=False)[0], 1, seeds=[0])
    for _ in range(150):
        batch.step()
    assert math.hypot(*(batch.pose[0, 0, :2] - [9, 2])) < 0.5
