"""`avoid` of `follow`: zones that the body stays out of."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import irsim

Make = Callable[..., Any]
RADIUS = 0.25
ZONE_RADIUS = 1.2
TEXT = """
world:
  width: 12
  height: 12
  zones:
    - {{name: talk, circle: {{center: [6, 6], radius: 1.2}}}}
    - {{name: door, line: [[1, 3], [11, 3]]}}
    - {{name: desk, rectangle: [8, 8, 11, 11]}}
robot:
  - {{name: scout, kinematics: {{name: {drive}}}, shape: {{name: circle, radius: 0.25}}, state: {state}, goal: {goal},
     vel_max: {limits}, behavior: {{name: follow, planner: {planner}, local: {local}{avoid}}}, goal_threshold: 0.2}}
obstacle:
  - {{number: 3, tags: [pedestrian], kinematics: {{name: static}}, shape: {{name: circle, radius: 0.25}},
     distribution: {{name: circle, center: [6, 6], radius: 0.8}}}}
"""
AVOID = ", avoid: [talk]"


def text_of(
    avoid: str = AVOID,
    drive: str = "diff",
    planner: str = "astar",
    local: str = "{name: orca, safe_radius: 0.3}",
    state: str = "[6, 1.5, 1.57]",
    goal: str = "[6, 10.5]",
) -> str:
    limits = "[1, 1, 1]" if drive == "omni_angular" else "[1, 1]"
    return TEXT.format(drive=drive, avoid=avoid, planner=planner, local=local, state=state, goal=goal, limits=limits)


def track_of(env: Any, steps: int = 400) -> Any:
    env.rollout(steps)
    return np.array(env.simulation.state.trajectory(env.robot.row))[:, :2]


def from_the_middle(track: Any) -> Any:
    return np.hypot(track[:, 0] - 6, track[:, 1] - 6)


def test_without_the_key_the_path_leads_through_the_zone(make: Make) -> None:
    env = make(text_of(avoid=""), seed=1)
    assert from_the_middle(track_of(env)).min() < ZONE_RADIUS
    assert env.robot.arrive


@pytest.mark.parametrize("drive", ["diff", "omni", "omni_angular", "acker"])
@pytest.mark.parametrize("planner", ["astar", "jps", "prm", "rrt"])
@pytest.mark.parametrize("local", ["dash", "orca"])
def test_the_body_stays_out_of_the_zone(make: Make, drive: str, planner: str, local: str) -> None:
    env = make(text_of(drive=drive, planner=planner, local=local), seed=1)
    assert from_the_middle(track_of(env)).min() > ZONE_RADIUS + RADIUS
    assert env.robot.arrive


def test_a_robot_that_others_meet_stays_out_of_the_zone(make: Make) -> None:
    people = """
  - {number: 4, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, behavior: {name: dash},
     state: [[3.5, 10, 0], [4.2, 11, 0], [7.8, 10.5, 0], [8.5, 9.5, 0]],
     goal: [[3.5, 1], [4.2, 1], [7.8, 1], [8.5, 1]]}
"""
    env = make(text_of(drive="omni") + people, seed=1)
    assert from_the_middle(track_of(env)).min() > ZONE_RADIUS + RADIUS
    assert env.robot.arrive


def test_one_that_starts_in_a_zone_leaves_it_by_the_nearest_side(make: Make) -> None:
    env = make(text_of(avoid=", avoid: [desk]", state="[9.5, 8.3, 0]"), seed=1)
    track = track_of(env)
    assert env.robot.arrive
    inside = (track[:, 0] > 8) & (track[:, 1] > 8)
    assert inside.any()
    assert track[inside, 1].max() < 8.4
    assert not inside[np.flatnonzero(inside).max() + 1 :].any()


def test_one_that_was_pushed_into_a_zone_leaves_it(make: Make) -> None:
    env = make(text_of(avoid=", avoid: [desk]", goal="[10, 7]"), seed=1)
    for _ in range(20):
        env.step()
    env.robot.set_state([9.5, 8.2, 0])
    for _ in range(200):
        env.step()
    assert env.robot.arrive


def test_a_line_is_not_crossed(make: Make) -> None:
    env = make(text_of(avoid=", avoid: [door, talk]", state="[5, 1.5, 1.57]"), seed=1)
    track = track_of(env)
    assert env.robot.arrive
    on_line = np.abs(track[:, 1] - 3) < RADIUS
    assert ((track[on_line, 0] < 1 - RADIUS) | (track[on_line, 0] > 11 + RADIUS)).all()


def test_without_another_way_there_is_no_path(make: Make) -> None:
    env = make(text_of(avoid=", avoid: [desk]", goal="[9.5, 9.5]"), seed=1)
    track_of(env, 50)
    assert [event.kind for event in env.events] == ["no_path"]


def problems(text: str) -> list[tuple[str, str]]:
    return [(f.severity, f.code) for f in irsim.validate(text=text).findings if f.severity != "hint"]


def test_avoided_zones_are_checked() -> None:
    assert problems(text_of()) == []
    assert problems(text_of(avoid=", avoid: [tolk]")) == [("error", "unknown-zone")]
    assert problems(text_of(avoid=", avoid: [desk]", goal="[9.5, 9.5]"))[0] == ("warning", "ends-in-zone")
    assert problems(text_of(avoid=", avoid: [desk]", goal="[7.8, 9.5]"))[0] == ("warning", "ends-in-zone")
    assert problems(text_of(avoid=", avoid: [desk]", goal="[7.7, 9.5]")) == []
    assert problems(text_of(avoid=", avoid: [talk]", state="[6, 6, 0]"))[0] == ("warning", "ends-in-zone")
    assert problems(text_of(avoid=", avoid: [door]", goal="[6, 3.1]"))[0] == ("warning", "ends-in-zone")


def test_a_misspelled_zone_is_repaired() -> None:
    [finding] = [f for f in irsim.validate(text=text_of(avoid=", avoid: [tolk]")).findings if f.code == "unknown-zone"]
    assert "talk" in (finding.fix or "")


def test_the_result_names_the_robot_that_entered_a_zone() -> None:
    through = irsim.run(text=text_of(avoid=""), seed=1)
    assert "'scout'" in through.summary
    assert through.zones["talk"].names == ["scout"]
    around = irsim.run(text=text_of(avoid=", avoid: [talk]"), seed=1)
    assert around.zones["talk"].objects == 0


def test_the_result_names_a_robot_that_was_in_a_zone_after_somebody_else() -> None:
    visitor = """
  - {name: anna, kinematics: {name: omni}, shape: {name: circle, radius: 0.25}, behavior: {name: dash},
     state: [9, 7.6, 0], goal: [9, 11]}
"""
    result = irsim.run(text=text_of(avoid="", goal="[9, 9.5]") + visitor, seed=1)
    assert result.zones["desk"].names == ["anna", "scout"]
    assert result.zones["desk"].robots == ["scout"]
    assert "first 'anna' at" in result.summary
    assert "the robot 'scout' later" in result.summary


def test_a_dry_run_names_the_robot_that_entered_a_zone() -> None:
    through = irsim.validate(text=text_of(avoid=""), simulate=True)
    assert through.dry_run is not None
    assert "'talk': 1 object" in through.dry_run.summary
    assert "first 'scout' at" in through.dry_run.summary
    around = irsim.validate(text=text_of(), simulate=True)
    assert around.dry_run is not None
    assert "talk" not in around.dry_run.summary
