"""Robots that patrol or wander: their first lap ends a run and the answer says so; corners that a robot cuts."""

from __future__ import annotations

from typing import Any

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.validation.validate import validate

PATROL = """\
world: {width: 10, height: 10, time_limit: 60}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 1, 0]
    waypoints: [[5, 1], [5, 5], [1, 5], [1, 1]]
    behavior: {name: dash, loop: true}
"""
SHUTTLE = PATROL.replace("waypoints: [[5, 1], [5, 5], [1, 5], [1, 1]]", "goal: [5, 1]")
WALL = "obstacle:\n  - {name: wall, shape: {name: rectangle, length: 0.2, width: 2}, state: [3, 6]}\n"


def test_the_answer_says_that_the_first_lap_ended_the_run_and_what_goes_on() -> None:
    result = irsim.run(text=PATROL)
    assert (result.outcome, result.robots[0].laps, result.until) == ("success", 1, "done")
    first = result.sim_time
    assert f"the robot patrols: it made its first lap by {first:.1f} s, which ended the run" in result.summary
    assert "(until: time_limit goes on to 60 s)" in result.summary
    on = irsim.run(text=PATROL, until="time_limit")
    assert (on.sim_time, on.outcome) == (pytest.approx(60), "success")
    assert on.robots[0].laps == sum(event.kind == "arrival" for event in on.events)
    assert f"the robot made {on.robots[0].laps} laps, the first by {first:.1f} s" in on.summary
    assert on.robots[0].laps is not None
    assert on.robots[0].laps > 2
    assert on.reproduce.startswith("irsim run scenario.yaml --until time_limit")


def test_the_try_before_the_run_says_it() -> None:
    tried = validate(text=PATROL, simulate=True).dry_run
    assert tried is not None
    assert "'robot_0' patrols: the run ends at its first lap (until: time_limit goes on)" in tried.summary
    assert "trip" in str(validate(text=SHUTTLE, simulate=True).dry_run)
    other = PATROL + SHUTTLE.partition("robot:\n")[2].replace("1, 1, 0", "1, 8, 0").replace("[5, 1]", "[5, 8]")
    tried = validate(text=other, simulate=True).dry_run
    assert "'robot_0', 'robot_1' patrol: each counts as arrived after its first lap" in str(tried)
    ends = "; 'robot_0' patrols: the run ends at its first lap (until: time_limit goes on)"
    assert validate(text=PATROL).summary.endswith(ends)
    assert "patrol" not in validate(text=PATROL.replace(", loop: true", "")).summary


def test_other_robots_have_no_laps() -> None:
    result = irsim.run(text=PATROL.replace(", loop: true", ""))
    assert result.robots[0].laps is None
    assert "patrol" not in result.summary
    assert result.summary.startswith("the robot arrived at")


def test_a_robot_that_is_hit_on_a_later_lap_has_failed() -> None:
    later = SHUTTLE + (
        "obstacle:\n  - {name: cart, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [3, 9],"
        " goal: [3, 1], start_time: 6, behavior: {name: dash}}\n"
    )
    assert irsim.run(text=later).outcome == "success"
    on = irsim.run(text=later, until="time_limit")
    assert on.outcome == "collision"
    assert on.summary.startswith("'robot_0' hit 'cart' at ")


def test_the_command_goes_on_counts_laps_and_repeats(tmp_path: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "patrol.yaml").write_text(PATROL, encoding="utf-8")
    shown = CliRunner().invoke(app, ["run", "patrol.yaml", "--until", "time_limit"])
    assert shown.exit_code == 0, shown.output
    assert "reproduce: irsim run patrol.yaml --until time_limit" in shown.output
    assert "laps" in shown.output.splitlines()[0]
    assert "60 s of simulated time" in shown.output
    moving = CliRunner().invoke(app, ["run", "patrol.yaml", "--until", "time_limit", "--steps", "260", "--record"])
    assert "260 steps" in moving.output


def test_a_robot_that_swings_out_behind_a_waypoint_is_told_by_how_much() -> None:
    fast = PATROL.replace("    behavior", "    vel_max: [1.5, 1.5]\n    behavior")
    result = irsim.run(text=fast.replace(", loop: true", ""))
    assert "'robot_0' swung out by up to 0.48 m from its straight way, after (" in result.summary
    exact = fast.replace("diff", "omni")
    assert "swung out" not in irsim.run(text=exact).summary
    assert "swung out" not in irsim.run(text=fast.replace("name: dash", "name: rvo")).summary


def test_the_count_of_steps_ends_at_its_total() -> None:
    told: list[tuple[int, int]] = []
    irsim.run(text=PATROL, progress=lambda done, total: told.append((done, total)))
    assert told[0][1] == 600
    assert told[-1][0] == told[-1][1] < 600


def test_a_dash_that_collided_when_tried_is_a_warning() -> None:
    straight = PATROL.replace(", loop: true", "").replace("[[5, 1], ", "[[5, 6], ").replace("1, 1, 0", "1, 6, 0") + WALL
    assert [item.severity for item in validate(text=straight).findings if item.code == "dash-into-obstacle"] == ["hint"]
    report = validate(text=straight, simulate=True)
    [item] = [item for item in report.findings if item.code == "dash-into-obstacle"]
    assert (item.severity, report.warnings) == ("warning", 1)
    assert item.message.endswith("it collided when tried")
    assert report.summary.endswith("; 1 warning")


TOUCHED = """\
world: {width: 12, height: 12, collision_mode: unobstructed_obstacles, time_limit: 30}
robot:
  - {name: r, state: [1, 6, 0], goal: [11, 6, 0], kinematics: {name: diff}, behavior: {name: dash}}
  - {name: far, state: [1, 11, 0], goal: [11, 11, 0], kinematics: {name: diff}, behavior: {name: dash}}
obstacle:
  - {name: walker, state: [6, 1], goal: [6, 11], kinematics: {name: omni}, behavior: {name: dash}}
"""


def test_a_touched_robot_that_goes_on_is_told_so() -> None:
    result = irsim.run(text=TOUCHED)
    assert result.outcome == "collision"
    assert "'r' hit 'walker' at " in result.summary
    assert "stood while they touched, and then went on; 2 of 2 robots arrived" in result.summary
    alone = irsim.run(text="".join(line for line in TOUCHED.splitlines(True) if "far" not in line))
    assert "and 'r' stands as long as they touch, while obstacles move on" in alone.summary


def test_the_reason_names_the_horizons_of_the_robots() -> None:
    ahead = TOUCHED.replace(
        "behavior: {name: dash}}", "behavior: {name: orca, timeHorizon: 0.2, timeHorizonObst: 1}}", 1
    )
    result = irsim.run(text=ahead)
    assert "'r' under orca avoids others 0.2 s ahead, static ones 1 s: timeHorizon" in str(result.reason)
