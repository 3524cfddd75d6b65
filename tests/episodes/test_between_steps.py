"""Contacts that begin and end within one step are told wherever a run is told: in words, numbers, tables and files."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app
from irsim.episodes.run_report import _first
from irsim.results.run import RunResult
from irsim.runs import open_run
from irsim.runs.comparison import diff_runs
from irsim.runs.inspection import inspect_run
from irsim.simulation.events import Event

TUNNEL = """\
world: {width: 12, height: 6, step_time: 0.1, time_limit: %s}
robot:
  - {name: runner, kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, state: [1, 3, 0], goal: [11, 3],
     goal_threshold: 0.3, behavior: {name: dash}, vel_max: [3, 3], vel_min: [-3, -3]}
obstacle:
  - {name: post, shape: {name: circle, radius: 0.05}, state: [5.05, 3.12]%s}
  - {name: board, shape: {name: rectangle, length: 0.02, width: 2}, state: [8.05, 3, 0]%s}
"""
"""A robot that moves 0.3 m per step grazes a post in step 14 and passes through a board in step 24."""
THROUGH = "'runner' passed through 'board' between two steps at 2.31 s, contact near (8.04, 3.00)"
CURE = "('runner' moved 0.3 m in that step; lower step_time, or set world.contacts: swept)"


SWEPT = """\
world: {width: 20, height: 10, step_time: 0.3, collision_mode: stop, contacts: swept, time_limit: 30}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, state: [5.2, 5, 0], goal: [18, 5],
     goal_threshold: 0.3, behavior: {name: dash}, vel_max: [1.5, 1.5], vel_min: [-3, -3]}
obstacle: [{shape: {name: rectangle, length: 0.02, width: 10}, state: [10, 5, 0]}]
"""
"""A step is 0.45 m, the robot 0.2 m plus the wall 0.02 m: at the end of no step the two touch."""
CONTACT = """\
world: {width: 20, height: 10, step_time: %s, collision_mode: contact, time_limit: 30}
robot:
  - {kinematics: {name: diff}, shape: {name: circle, radius: 0.1}, state: [5.13, 5, 0], goal: [18, 5],
     behavior: {name: dash}, vel_max: [3, 3], vel_min: [-3, -3]}
obstacle: [{shape: {name: rectangle, length: 0.02, width: 10}, state: [10, 5, 0]}]
"""
"""A step of 0.1 s is 0.3 m; the wall stands in the way."""


def scene(limit: float = 30, post: str = "", board: str = "") -> str:
    return TUNNEL % (limit, post, board)


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current directory."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tunnel.yaml").write_text(scene())
    return tmp_path


def printed(*arguments: str) -> str:
    result = CliRunner().invoke(app, list(arguments))
    assert result.exit_code == 0, result.output
    return " ".join(result.output.split())


def test_a_success_that_passed_a_wall_says_so_first() -> None:
    result = irsim.run(text=scene())
    assert result.outcome == "success"  # contacts count at the ends of steps
    assert result.summary.startswith(f"{THROUGH}, one of 2 contacts between steps {CURE}; the robot arrived at 3.3 s")
    assert "without touching" not in result.summary
    assert (result.reason, result.decisive_step) == (None, None)
    [runner] = result.robots
    assert (runner.collision_count, runner.contacts_between_steps, runner.passed_through) == (0, 2, ["board"])
    assert result.contacts_between_steps == 2
    told = [(event.kind, event.step, event.object, event.partner) for event in result.events]
    assert told == [
        ("contact_between_steps", 14, "runner", "post"),
        ("passed_through", 24, "runner", "board"),
        ("arrival", 33, "runner", None),
    ]
    graze, through, _ = result.events
    assert graze.time == pytest.approx(1.32, abs=1e-3)  # 0.09 m before the post, of 0.3 m per step
    assert graze.depth == pytest.approx(0.03, abs=1e-6)
    assert through.time == pytest.approx(2.3133, abs=1e-3)


def test_the_reason_of_a_failure_begins_with_it() -> None:
    result = irsim.run(text=scene(limit=2.8))
    assert result.outcome == "timeout"
    assert result.reason is not None
    assert result.reason.startswith(
        f"{THROUGH}, one of 2 contacts between steps {CURE}; at the time limit of 2.8 s (world.time_limit) "
    )
    assert result.summary.startswith(f"{THROUGH}, one of 2 contacts between steps; the robot did not arrive")
    assert result.decisive_step == 24


def test_a_graze_is_told_with_its_overlap() -> None:
    result = irsim.run(text=scene(board=", unobstructed: true"))
    what = "'runner' and 'post' touched between two steps at 1.32 s, contact near (5.02, 3.08), overlapping by 0.03 m "
    assert result.summary.startswith(what + CURE)
    assert result.robots[0].passed_through == []


def test_a_failure_whose_robot_only_grazed_something_is_not_decided_by_that() -> None:
    late = irsim.run(text=scene(limit=2.8, board=", unobstructed: true"))
    assert late.reason is not None
    assert late.reason.startswith("'runner' and 'post' touched between two steps")
    assert late.decisive_step is None


def test_nothing_is_told_of_what_others_pass_through_or_where_steps_are_short() -> None:
    ghosts = irsim.run(text=scene(post=", unobstructed: true", board=", unobstructed: true"))
    assert (ghosts.contacts_between_steps, "between" in ghosts.summary) == (0, False)
    short = irsim.run(text=scene().replace("step_time: 0.1", "step_time: 0.02"))
    assert (short.outcome, short.contacts_between_steps) == ("collision", 0)
    assert "between two steps" not in short.summary


def test_swept_contacts_are_collisions_and_told_once() -> None:
    """They are not told as contacts between steps, too, and nothing is counted twice."""
    text = scene().replace("step_time: 0.1", "step_time: 0.1, contacts: swept")
    result = irsim.run(text=text)
    assert (result.outcome, result.decisive_step) == ("collision", 14)
    assert result.reason == "'runner' hit 'post' at 1.32 s, contact near (5.02, 3.08)"
    assert (result.robots[0].collision_count, result.contacts_between_steps) == (1, 0)
    assert "between" not in result.summary
    driven = irsim.run(text=text.replace("contacts: swept", "contacts: swept, collision_mode: unobstructed"))
    assert driven.outcome == "collision"  # it drives on and arrives, after both
    assert driven.reason == "'runner' hit 'post' at 1.32 s, contact near (5.02, 3.08)"
    assert driven.robots[0].collision_count == 2
    assert "between two steps" not in driven.summary


def test_robots_that_pass_through_each_other() -> None:
    fast = "kinematics: {name: omni}, shape: {name: circle, radius: 0.1}, behavior: {name: dash}, goal_threshold: 0.6"
    limits = "vel_max: [9, 9], vel_min: [-9, -9]"
    text = (
        "world: {width: 12, height: 6, step_time: 0.1, time_limit: 5}\nrobot:\n"
        f"  - {{name: ann, {fast}, {limits}, state: [1, 3, 0], goal: [11, 3]}}\n"
        f"  - {{name: bob, {fast}, {limits}, state: [11, 3, 0], goal: [1, 3]}}\n"
    )
    result = irsim.run(text=text)
    assert result.summary.startswith("'ann' passed through 'bob' between two steps at 0.5")
    assert {robot.name: robot.passed_through for robot in result.robots} == {"ann": ["bob"], "bob": ["ann"]}
    assert result.contacts_between_steps == 1


def test_people_that_touch_each_other_between_steps_are_counted_after_the_robots() -> None:
    walk = "kinematics: {name: omni}, shape: {name: circle, radius: 0.1}, behavior: {name: dash}, goal_threshold: 0.6"
    limits = "vel_max: [9, 9], vel_min: [-9, -9]"
    text = (
        "world: {width: 12, height: 6, step_time: 0.1, time_limit: 2}\n"
        "robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [2, 1], behavior: {name: dash}}\nobstacle:\n"
        f"  - {{name: ann, {walk}, {limits}, state: [1, 3, 0], goal: [11, 3]}}\n"
        f"  - {{name: bob, {walk}, {limits}, state: [11, 3, 0], goal: [1, 3]}}\n"
    )
    result = irsim.run(text=text)
    assert not result.summary.startswith("'ann'")
    assert "; 1 contact between steps without a robot" in result.summary
    assert (result.contacts_between_steps, result.robots[0].contacts_between_steps) == (1, 0)


def test_they_stay_among_the_events_of_a_long_run() -> None:
    busy = [Event("waypoint", k / 10, k, "runner", None, 0.0, 0.0) for k in range(300)]
    contact = Event("passed_through", 29.95, 300, "runner", "board", 8.0, 3.0, depth=0.1)
    listed = _first([*busy, contact])
    assert (len(listed), listed[-1], listed[0]) == (100, contact, busy[0])


def test_programs_see_them(workspace: Path, capsys: pytest.CaptureFixture[str]) -> None:
    env = irsim.make("tunnel.yaml", display=False, headless=True, log_level="WARNING")
    for _ in range(33):
        env.step()
    kinds = [event.kind for event in env.events]
    assert kinds == ["contact_between_steps", "passed_through", "arrival"]
    assert (env.robot.contacts_between_steps, env.outcome) == (2, "success")
    env.reset()
    assert (env.robot.contacts_between_steps, env.events) == (0, [])
    env.end(ending_time=0.0)
    logged = capsys.readouterr().out
    assert "runner passed through board between two steps at 2.313 s, contact near (8.04, 3.00)" in logged
    assert "runner touched post between two steps" in logged


def test_the_command_shows_them_in_its_table_and_in_json(workspace: Path) -> None:
    shown = printed("run", "tunnel.yaml", "--record")
    assert "collisions between steps" in shown
    assert f"success: {THROUGH}" in shown
    assert "jumps-through" in shown
    result = json.loads(CliRunner().invoke(app, ["run", "tunnel.yaml", "--json"]).stdout)
    assert (result["contacts_between_steps"], result["robots"][0]["passed_through"]) == (2, ["board"])
    assert "between steps" not in printed("run", "tunnel.yaml", "--policy", "orca")  # which is slower at the post
    rows = list(
        csv.DictReader(
            CliRunner().invoke(app, ["inspect", "last", "--view", "collisions", "--csv"]).stdout.splitlines()
        )
    )
    assert [(row["kind"], row["partner"], row["depth"]) for row in rows] == [
        ("contact_between_steps", "post", "0.03"),
        ("passed_through", "board", "0.11"),
    ]


def test_records_tell_them_and_records_of_before_still_open(workspace: Path) -> None:
    result = irsim.run("tunnel.yaml", record=True)
    assert result.run_id is not None
    run = open_run(result.run_id)
    assert [event._asdict() for event in run.events] == [event.model_dump() for event in result.events]
    table = inspect_run(run, view="collisions")
    assert table.columns[-2:] == ["kind", "depth"]
    assert [(row[0], row[1], row[3], row[-2]) for row in table.rows] == [
        (14, pytest.approx(1.32, abs=1e-3), "post", "contact_between_steps"),
        (24, pytest.approx(2.3133, abs=1e-3), "board", "passed_through"),
    ]
    old = result.model_dump(mode="json")
    for key in ("contacts_between_steps", "depth", "passed_through"):
        for part in (old, *old["robots"], *old["events"]):
            part.pop(key, None)
    old["events"] = [event for event in old["events"] if event["kind"] == "arrival"]
    opened = RunResult.model_validate(old)
    assert (opened.contacts_between_steps, opened.robots[0].contacts_between_steps) == (0, 0)
    assert Event(**old["events"][0]).depth is None


def test_runs_that_differ_only_in_them_are_told_apart(workspace: Path) -> None:
    first, second = (open_run(str(irsim.run("tunnel.yaml", record=True).run_id)) for _ in range(2))
    assert diff_runs(first, second).same
    second.__dict__["events"] = [event for event in second.events if event.kind != "passed_through"]
    difference = diff_runs(first, second)
    assert not difference.same
    assert [(event.kind, event.partner) for event in difference.events_before] == [("passed_through", "board")]


def test_exports_flag_them(workspace: Path) -> None:
    run = open_run(str(irsim.run("tunnel.yaml", record=True).run_id))
    irsim.export_run(run, "run.csv")
    with open("run.csv", newline="", encoding="utf-8") as file:
        flagged = [row["step"] for row in csv.DictReader(file) if row["between_steps"] == "1"]
    assert flagged == ["14", "24"]
    irsim.export_run(run, "run.npz")
    with np.load("run.npz") as arrays:
        assert np.flatnonzero(arrays["between_steps"][:, 0]).tolist() == [14, 24]


def test_a_benchmark_counts_them(workspace: Path) -> None:
    result = irsim.benchmark(["tunnel.yaml"], policies=["dash"], seeds=1)
    [episode] = result.episodes
    assert (episode.outcome, episode.metrics["contacts_between_steps"], episode.metrics["collision_count"]) == (
        "success", 2.0, 0.0,
    )  # fmt: skip
    assert result.incidents == ["robots touched something between steps in 1 of 1 episodes (seed 0)"]
    assert result.rows[0].incidents == {"contacts_between_steps": 1}
    assert "between" in printed("benchmark", "tunnel.yaml", "--policies", "dash", "--seeds", "1")


def test_a_dry_run_tells_them() -> None:
    dry_run = irsim.validate(text=scene(), simulate=True).dry_run
    assert dry_run is not None
    assert [event.kind for event in dry_run.contacts_between_steps] == ["contact_between_steps", "passed_through"]
    assert THROUGH in dry_run.summary


def test_a_swept_contact_stops_a_robot_at_the_wall(workspace: Path) -> None:
    (workspace / "tunnel.yaml").write_text(SWEPT)
    shown = CliRunner().invoke(app, ["run", "tunnel.yaml", "--require-success"])
    assert shown.exit_code == 1
    assert "'robot_0' hit 'obstacle_1' at 3.13 s, contact near (9.99, 5.00)" in " ".join(shown.stdout.split())
    result = irsim.run("tunnel.yaml")
    assert (result.outcome, result.contacts_between_steps) == ("collision", 0)
    assert result.robots[0].pose[0] == pytest.approx(9.89, abs=1e-3)  # its radius before the face of the wall


@pytest.mark.parametrize("step_time", [0.1, 0.5, 1])
def test_nothing_passes_in_contact_mode(workspace: Path, step_time: float) -> None:
    (workspace / "tunnel.yaml").write_text(CONTACT % step_time)
    shown = printed("run", "tunnel.yaml")
    assert "timeout: the robot did not arrive within 30 s" in shown
    assert "stands still 8.11 m from its goal, and it pushes against 'obstacle_1'" in shown
    result = irsim.run("tunnel.yaml")
    assert (result.outcome, result.contacts_between_steps) == ("timeout", 0)
    assert result.robots[0].pose[0] == pytest.approx(9.89, abs=1e-3)
    assert "without touching" not in result.summary  # it leans on the wall
