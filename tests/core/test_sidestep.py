"""sidestep: a preference for one side, where something is ahead."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest

import irsim

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
    result = irsim.run(text=head_on(f"{LOCALS[name]}, sidestep: 10"), seed=0)
    assert result.outcome == "success", result.reason
    assert max(robot.time_to_goal or math.inf for robot in result.robots) < 12
    without = irsim.run(text=head_on(f"{LOCALS[name]}, sidestep: 0"), seed=0)
    assert without.outcome != "success"


@pytest.mark.parametrize("name", LOCALS)
def test_a_faster_one_passes_a_slower_one_straight_ahead(name: str) -> None:
    robots = ([3, 5, 0], [19, 5], 0.4), ([1, 5, 0], [18, 5], 1.2)
    result = irsim.run(text=world(f"{LOCALS[name]}, sidestep: 10", *robots), seed=0)
    behind = result.robots[1]
    assert (behind.time_to_goal or math.inf) < 18
    assert not [event for event in result.events if event.kind == "collision"]


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
    result = irsim.run(text=text, seed=0)
    assert result.outcome == "success", result.reason
