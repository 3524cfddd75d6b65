"""Robots on routes go round others that stand for good on their path, and say who is in the way where they cannot."""

from __future__ import annotations

import pytest

import irsim


def scene(parked: str, behavior: str, doors: str = "two", after: str = "freeze") -> str:
    """Two rooms with doors between them, a robot that comes to stand in the first door, and one that wants through."""
    middle = 4.4 if doors == "two" else 8.2
    return f"""
world: {{width: 20, height: 12, after_arrival: {after}, boundary: walls, time_limit: 90}}
robot:
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.4}}, vel_max: [1, 3], vel_min: [-1, -3], {parked}}}
  - {{kinematics: {{name: diff}}, shape: {{name: circle, radius: 0.3}}, vel_max: [1, 3], vel_min: [-1, -3],
      state: [1, 3, 0], goal: [18, 3], goal_threshold: 0.3, behavior: {behavior}}}
obstacle:
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, 1.1, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: {middle}}}, state: [10, {3.8 + middle / 2}, 0]}}
  - {{shape: {{name: rectangle, length: 0.4, width: 2.2}}, state: [10, 10.9, 0]}}
"""


ARRIVES = "state: [6, 3, 0], goal: [10, 3], behavior: {name: dash}"
HITS = "state: [10, 2.68, 1.5708], goal: [10, 5], behavior: {name: dash}"
LOCALS = ["orca", "footprint_orca", "dash", "rvo"]


@pytest.mark.parametrize("local", LOCALS)
@pytest.mark.parametrize("parked", [ARRIVES, HITS], ids=["arrived", "stopped by a collision"])
def test_the_other_door_is_taken_when_someone_stands_in_the_first(local: str, parked: str) -> None:
    result = irsim.run(text=scene(parked, f"{{name: follow, local: {local}}}"))
    assert result.robots[1].outcome == "success", result.reason


@pytest.mark.parametrize("local", ["orca", "dash"])
def test_who_stands_in_the_only_door_is_named(local: str) -> None:
    result = irsim.run(text=scene(ARRIVES, f"{{name: follow, local: {local}}}", doors="one"))
    assert result.robots[1].outcome == "timeout"
    assert "there is no way round 'robot_0', which has arrived there" in result.reason
    assert "after_arrival: yield" in result.reason
    named = [event.partner for event in result.events if event.kind == "no_path"]
    assert named == ["robot_0"]


def test_no_one_is_told_to_write_what_is_written() -> None:
    result = irsim.run(text=scene(ARRIVES, "{name: follow, local: orca}", doors="one", after="yield"))
    assert result.robots[1].outcome == "timeout"
    assert "no way round 'robot_0', which has arrived there (move the goal of 'robot_0' aside)" in result.reason


def test_a_dry_run_names_who_stands_in_the_way() -> None:
    report = irsim.validate(text=scene(ARRIVES, "{name: follow, local: orca}", doors="one"), simulate=True)
    assert report.dry_run is not None
    assert any("no way round 'robot_0'" in stuck.why for stuck in report.dry_run.stuck)


def test_a_path_that_nobody_stands_on_stays() -> None:
    free = irsim.run(
        text=scene("state: [5, 10, 0], goal: [5, 11], behavior: {name: dash}", "{name: follow, local: orca}")
    )
    assert free.robots[1].outcome == "success"
    assert free.robots[1].path_length < 17.6
