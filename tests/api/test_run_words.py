"""Sentences in the result of a run about fog, maps, people and headings."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from irsim.api import run, validate
from irsim.results.run import RunResult

FOG = """\
world: {width: 10, height: 4, fog_map: true, time_limit: 20}
robot: {name: scout, kinematics: {name: diff}, state: [1, 2, 0], goal: [9, 2], behavior: {name: dash},
        shape: {name: circle, radius: 0.2}, sensors: [{name: lidar2d, number: 720, range_max: 4, angle_range: 6.28}]}
"""
PARK = """\
world: {width: 10, height: 4, time_limit: 30, boundary: walls}
robot: {name: box, kinematics: {name: omni_angular}, state: [1, 2, 0], goal: [7, 2, 1.57], arrive_mode: state,
        behavior: {name: dash}, shape: {name: circle, radius: 0.2}}
"""
PEOPLE = """\
world: {width: 12, height: 6, collision_mode: unobstructed_obstacles, time_limit: 20}
robot: {kinematics: {name: diff}, state: [1, 5, 0], goal: [9, 5], behavior: {name: dash},
        shape: {name: circle, radius: 0.2}}
obstacle:
  - {name: ann, kinematics: {name: omni}, state: [1, 1], goal: [9, 1], behavior: {name: dash},
     shape: {name: circle, radius: 0.2}}
  - {name: bob, kinematics: {name: omni}, state: [9, 2], goal: [1, 2], behavior: {name: dash},
     shape: {name: circle, radius: 0.2}}
"""


def result_of(text: str, tmp_path: Path) -> RunResult:
    file = tmp_path / "scene.yaml"
    file.write_text(text, encoding="utf-8")
    return run(file)


def test_the_explored_share_is_told(tmp_path: Path) -> None:
    result = result_of(FOG, tmp_path)
    assert result.explored is not None
    assert 0.9 < result.explored <= 1
    assert (
        f"explored {100 * result.explored:.0f} % of the area of the world, insides of obstacles incl" in result.summary
    )


def test_the_error_of_a_heading_that_counts_and_the_walls_are_told(tmp_path: Path) -> None:
    (robot,) = result_of(PARK, tmp_path).robots
    assert robot.outcome == "success"
    assert robot.heading_error == pytest.approx(0, abs=0.2)
    assert robot.nearest_called == "the walls round the world"
    assert robot.min_clearance == pytest.approx(0.8, abs=0.01)
    assert robot.nearest_at is not None


def test_people_who_may_overlap_but_do_not_are_told(tmp_path: Path) -> None:
    assert "no contacts between people" in result_of(PEOPLE, tmp_path).summary
    stopped = PEOPLE.replace("collision_mode: unobstructed_obstacles, ", "")
    assert "contacts between people" not in result_of(stopped, tmp_path).summary


def test_a_dry_run_does_not_repeat_the_hint_about_behaviors() -> None:
    text = "robot: [{kinematics: {name: diff}, state: [1, 1], goal: [8, 8]}]\n"
    report = validate(text=text, simulate=True)
    assert [item.code for item in report.findings].count("no-behavior") == 1
    assert report.dry_run is not None
    assert "stands since" not in report.dry_run.summary
    assert report.dry_run.stuck[0].why.startswith("it has no behavior")


def test_the_place_of_a_collision_is_right_though_others_drive_on() -> None:
    # Robots that have stopped leave no track, so the track does not tell in which step they stopped.
    robots = [("a", [1, 5, 0], [9, 5]), ("b", [9, 5, 3.1416], [1, 5]), ("c", [1, 1, 0], [9, 1])]
    text = yaml.safe_dump({
        "world": {"width": 10, "height": 10, "collision_mode": "stop"},
        "robot": [{"name": name, "kinematics": {"name": "omni"}, "shape": {"name": "circle", "radius": 0.25},
                   "state": state, "goal": goal, "vel_max": [1, 1], "behavior": {"name": "dash"}}
                  for name, state, goal in robots],
    })  # fmt: skip
    by_name = {robot.name: robot for robot in run(text=text, seed=0).robots}
    for name, x in (("a", 4.75), ("b", 5.25)):
        assert by_name[name].outcome == "collision"
        assert by_name[name].nearest_at == pytest.approx((x, 5), abs=0.11)
