"""Results in words: the step that decided an episode, who stood since, fog, maps, people, headings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import irsim
from irsim.api import run, snapshot, validate
from irsim.episodes.progress import stalled_since
from irsim.policies import FunctionPolicy
from irsim.results.run import RunResult

BODY = "kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, behavior: {name: dash}"
WALKER = "kinematics: {name: omni}, shape: {name: circle, radius: 0.2}, behavior: {name: dash}, tags: [pedestrian]"
TOUCH = f"""
world: {{width: 12, height: 6}}
robot:
  - {{name: a, {BODY}, state: [1, 3, 0], goal: [11, 3]}}
  - {{name: b, {BODY}, state: [11, 3, 3.14159], goal: [1, 3]}}
  - {{name: c, {BODY}, state: [1, 1, 0], goal: [11, 1]}}
obstacle:
  - {{name: p, {WALKER}, state: [3, 5, 0], goal: [3, 1.6]}}
  - {{name: q, {WALKER}, state: [3, 4, 0], goal: [3, 5.5]}}
"""


def test_the_collision_of_robots_decides_and_not_an_earlier_one_of_obstacles() -> None:
    result = irsim.run(text=TOUCH)
    first = result.events[0]
    assert (first.kind, first.object, first.step) == ("collision", "p", 4)
    assert result.outcome == "collision"
    assert result.decisive_step == 48
    assert "'a' hit 'b' at 4.8 s, contact near (6.00, 3.00), and both have stood still since" in result.summary


def test_success_has_no_decisive_step() -> None:
    result = irsim.run(text=f"world: {{width: 9, height: 4}}\nrobot: {{{BODY}, state: [1, 2, 0], goal: [4, 2]}}\n")
    assert (result.outcome, result.decisive_step) == ("success", None)


def test_a_jump_over_the_goal_decides_a_time_out() -> None:
    text = f"""
world: {{width: 12, height: 6}}
robot: {{{BODY}, state: [1, 3, 0], goal: [9.93, 3], vel_max: [2, 1.5], vel_min: [-2, -1.5], goal_threshold: 0.06}}
"""
    result = irsim.run(text=text)
    assert (result.outcome, result.decisive_step) == ("timeout", 45)
    assert "at no step from then on nearer than 0.07 m" in result.summary


def test_a_robot_that_is_caught_is_decided_when_it_ceases_to_get_on() -> None:
    text = """
world: {width: 10, height: 6, time_limit: 20}
robot: {kinematics: {name: diff}, shape: {name: circle, radius: 0.3}, state: [1, 3, 0], goal: [9, 3],
        behavior: {name: sfm}}
obstacle: {shape: {name: linestring, vertices: [[-5, 2], [0, 2], [0, -2], [-5, -2]]}, state: [5, 3, 0]}
"""
    result = irsim.run(text=text)
    assert result.outcome == "timeout"
    assert result.decisive_step is not None
    assert 20 < result.decisive_step < 120


def test_a_robot_that_passed_its_goal_and_came_back_is_in_the_summary() -> None:
    text = """
world: {width: 12, height: 6}
robot: {name: fast, kinematics: {name: omni, noise: true, alpha: [0.1, 0.1]}, shape: {name: circle, radius: 0.2},
        state: [1, 3, 0], goal: [9.93, 3], vel_max: [1.5, 1.5], vel_min: [-1.5, -1.5], goal_threshold: 0.05,
        behavior: {name: dash}}
"""
    result = irsim.run(text=text, seed=0)
    assert (result.outcome, result.jumped) == ("success", [])
    assert "'fast' passed its goal between two steps at 6.1 s, came back and arrived at 6.3 s" in result.summary


def test_a_picture_beyond_the_end_of_the_episode_says_so() -> None:
    assert snapshot(text=TOUCH, steps=100, draw=False).ended is None
    assert snapshot(text=TOUCH, steps=101, draw=False).ended == 100
    limited = TOUCH.replace("height: 6", "height: 6, time_limit: 2")
    assert snapshot(text=limited, steps=40, draw=False).ended == 20


def test_a_picture_that_follows_a_viewpoint_says_what_it_shows() -> None:
    followed = TOUCH.replace("height: 6", "height: 6, plot: {viewpoint: a}")
    assert snapshot(text=followed, draw=False).view == (-5.0, 7.0, 0.0, 6.0)
    assert snapshot(text=followed, region=[0, 0, 4, 4], draw=False).view is None
    assert snapshot(text=TOUCH, draw=False).view is None


CREEPER = """
world: {width: 12, height: 8, time_limit: 40}
robot: {name: r, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [2, 4, 0], goal: [10, 4]}
"""


def test_a_robot_that_creeps_without_touching_anything_is_decided_when_it_begins_to_creep() -> None:
    def creep(seen: Any) -> Any:
        ahead = np.zeros_like(seen.pose[:, :2])
        ahead[:, 0] = np.where(seen.pose[:, 0] < 5, 0.8, 0.0)
        ahead[:, 1] = np.where(seen.pose[:, 0] < 5, 0.0, 0.04)
        return ahead

    result = irsim.run(text=CREEPER, policy=FunctionPolicy(creep, output="velocity"))
    assert result.outcome == "timeout"
    assert result.decisive_step == pytest.approx(34, abs=6)
    assert "still moved at 0.04 m/s" in str(result.reason)
    assert "hardly nearer than at 3" in str(result.reason)


def test_a_robot_that_goes_to_and_fro_is_decided_too_and_one_on_a_detour_is_not() -> None:
    time = 0.1 * np.arange(400)
    fro = np.stack([5 + np.zeros(400), 4 + np.sin(time)], axis=1)
    there = np.stack([np.linspace(2, 5, 40), np.full(40, 4.0)], axis=1)
    goal = np.array([10.0, 4.0])
    since = stalled_since(np.concatenate([there, fro]), goal, 0.1, 1.0)
    assert since == pytest.approx(40, abs=15)
    detour = np.stack([np.full(400, 5.0), 4 + time], axis=1)
    assert stalled_since(np.concatenate([there, detour]), goal, 0.1, 1.0) is None
    assert stalled_since(there, goal, 0.1, 1.0) is None, "too short"


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
    assert "no contacts between moving obstacles" in result_of(PEOPLE, tmp_path).summary  # no word says people
    tagged = PEOPLE.replace("name: ann", "name: ann, tags: [pedestrian]").replace("name: bob", "name: walker_2")
    assert "no contacts between people" in result_of(tagged, tmp_path).summary
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
