"""Incidents besides outcomes are counted and said in the headline: contacts between people, exits, jumps, no room."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.cli.app import app

PEOPLE = """
world: {width: 10, height: 10, time_limit: 12, collision_mode: %s}
robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [3, 1], shape: {name: circle, radius: 0.2},
        behavior: {name: dash}}
obstacle:
  - {name: ann, kinematics: {name: omni}, state: [2, 5, 0], goal: [9, 5], shape: {name: circle, radius: 0.3},
     behavior: {name: dash}, tags: [pedestrian]}
  - {name: bob, kinematics: {name: omni}, state: [8, 5, 0], goal: [1, 5], shape: {name: circle, radius: 0.3},
     behavior: {name: dash}, tags: [pedestrian]}
"""
AWAY = """
world: {width: 6, height: 6, time_limit: 10}
robot:
  - {name: stray, kinematics: {name: diff}, state: [5, 1, 0], goal: [8, 1], behavior: {name: dash}}
  - {name: fast, kinematics: {name: diff}, state: [0.7, 3, 0], goal: [3, 3], vel_max: [10, 1], vel_min: [-10, -1],
     shape: {name: circle, radius: 0.2}, behavior: {name: dash}}
"""
CROWDED = """
world: {width: 5, height: 5, time_limit: 4}
robot:
  - {number: %d, kinematics: {name: diff}, shape: {name: circle, radius: 0.4}, behavior: {name: orca},
     distribution: {name: random, range_low: [0.5, 0.5, -3], range_high: [4.5, 4.5, 3]}}
"""


def people(mode: str) -> str:
    """The robot has a long way, so that people meet before it arrives."""
    return (PEOPLE % mode).replace("goal: [3, 1]", "goal: [9, 1]")


def test_contacts_between_people_are_in_the_summary_of_a_run() -> None:
    result = irsim.run(text=PEOPLE % "unobstructed_obstacles", steps=80)
    assert (result.outcome, result.human_contacts) == ("success", 0)  # it ended before they met
    for mode, told in (
        ("unobstructed_obstacles", "('ann' hit 'bob' at 2.8 s)"),
        ("stop", "; 2 of 2 moving obstacles were stopped by a collision ('ann' hit 'bob'"),
    ):
        late = irsim.run(text=people(mode))
        assert late.human_contacts == 1
        assert f"; 1 contact between people{told}" in late.summary.replace("people (", "people(")


def test_the_first_contact_is_said_once() -> None:
    """Robots can be people, too: their collisions are in the summary already."""
    both = (PEOPLE % "stop").replace("goal: [3, 1]", "goal: [9, 1], tags: [pedestrian]")
    both = both.replace("state: [2, 5, 0]", "state: [9, 1, 3.14]").replace("goal: [9, 5]", "goal: [1, 1]")
    result = irsim.run(text=both)
    assert result.human_contacts == 1
    assert result.summary.count("hit 'ann' at") == 1
    assert "; 1 contact between people" in result.summary


def test_robots_that_left_or_jumped_are_in_the_summary_of_a_run() -> None:
    result = irsim.run(text=AWAY)
    assert [item.name for item in result.left] == ["stray"]
    assert result.jumped == ["fast"]
    [jump] = [event for event in result.events if event.kind == "overshoot" and event.object == "fast"][:1]
    assert (
        f"'fast' jumped over its goal at {round(jump.time, 2):g} s, at no step from then on nearer than 0.3 m "
        in result.summary
    )
    assert "(raise goal_threshold above that or lower step_time)" in result.summary
    assert "'stray' left the world at" in result.summary


def test_who_arrives_after_a_jump_is_not_in_the_summary() -> None:
    """A robot that passes its goal at first and comes back has arrived."""
    text = AWAY.replace("step_time: 0.1", "").replace("vel_max: [10, 1]", "vel_max: [10, 1], acce: [4, 9]")
    result = irsim.run(text=text.replace("goal: [3, 3]", "goal: [3, 3], goal_threshold: 0.3"))
    robots = {robot.name: robot.outcome for robot in result.robots}
    assert (robots["fast"], result.jumped, "jumped" in result.summary) == ("success", [], False)


def test_incidents_of_a_benchmark_are_counted_and_come_first(tmp_path: Path) -> None:
    (tmp_path / "people.yaml").write_text(people("unobstructed_obstacles"))
    (tmp_path / "away.yaml").write_text(AWAY)
    files = [str(tmp_path / "people.yaml"), str(tmp_path / "away.yaml")]
    result = irsim.benchmark(files, seeds=3, perturb="speed=5%")
    counted = [(one.human_contacts, one.left, bool(one.jumped)) for one in result.episodes]
    assert counted == [(1, [], False)] * 3 + [(0, ["stray"], True)] * 3
    assert [row.incidents for row in result.rows[:2]] == [{"human_contacts": 3}, {"left": 3, "jumped": 3}]
    assert result.incidents == [
        "contacts between people, or other moving obstacles, in 3 of 6 episodes (3 contacts; seeds 0, 1, 2)",
        "objects left the world in 3 of 6 episodes (seeds 0, 1, 2)",
        "objects jumped over their goal in 3 of 6 episodes (seeds 0, 1, 2)",
    ]
    shown = CliRunner().invoke(app, ["benchmark", *files, "--seeds", "3", "--perturb", "speed=5%"]).output
    assert shown.splitlines()[0] == "; ".join(result.incidents)


def test_where_nothing_happened_nothing_is_said(tmp_path: Path) -> None:
    (tmp_path / "calm.yaml").write_text(PEOPLE % "stop")
    result = irsim.benchmark(str(tmp_path / "calm.yaml"))
    assert (result.incidents, result.rows[0].incidents) == ([], {})
    shown = CliRunner().invoke(app, ["benchmark", str(tmp_path / "calm.yaml")]).output
    assert shown.splitlines()[0].startswith("scenario ")


@pytest.fixture
def crowded(tmp_path: Path) -> str:
    (tmp_path / "crowded.yaml").write_text(CROWDED % 15)
    return str(tmp_path / "crowded.yaml")


def test_a_seed_without_room_is_an_outcome_of_its_own(crowded: str, at_once: None) -> None:
    result = irsim.benchmark(crowded, ["orca", "rvo"], 12, workers=1)
    without = [episode.seed for episode in result.episodes[:12] if episode.outcome == "placement-crowded"]
    assert 0 < len(without) < 12
    for seed in range(12):
        if seed in without:
            with pytest.raises(irsim.PlacementError, match=f"with seed {seed}"):
                irsim.run(crowded, seed=seed)
    for row in result.rows:
        ends = [e.outcome for e in result.episodes if e.behavior == row.behavior and e.seed not in without]
        assert row.episodes == row.success.n == row.collision.n == row.timeout.n == len(ends)
        assert row.success.count + row.collision.count + row.timeout.count == len(ends)
        assert row.incidents["placement-crowded"] == len(without)
        assert not set(without) & {seed for seeds in row.failed.values() for seed in seeds}
    assert result.rows[1].paired["success"].n == 12 - len(without)
    listed = ", ".join(map(str, without[:5])) + (f" and {len(without) - 5} more" if len(without) > 5 else "")
    told = f"{len(without)} of 12 seeds had no room and do not count (placement-crowded): {listed}"
    assert result.incidents[-1] == told
    many = irsim.benchmark(crowded, ["orca", "rvo"], 12, workers=3)
    assert many.model_dump_json() == result.model_dump_json()
    empty = next(episode for episode in result.episodes if episode.seed in without)
    assert (empty.steps, empty.failures, set(empty.metrics.values())) == (0, {}, {None})


def test_the_table_counts_seeds_without_room_beside_n(crowded: str) -> None:
    result = irsim.benchmark(crowded, seeds=12)
    shown = CliRunner().invoke(app, ["benchmark", crowded, "--seeds", "12"]).output.splitlines()
    assert "seeds had no room and do not count (placement-crowded)" in shown[0]
    [line] = [line.split() for line in shown if line.startswith("crowded ")]
    assert line[2] == str(result.rows[0].episodes)
    table = CliRunner().invoke(app, ["benchmark", crowded, "--seeds", "12", "--csv"]).stdout
    rows = list(csv.DictReader(io.StringIO(table)))
    assert [row["outcome"] for row in rows] == [episode.outcome for episode in result.episodes]


def test_where_no_seed_has_room_there_is_no_row(tmp_path: Path) -> None:
    (tmp_path / "full.yaml").write_text(CROWDED % 25)
    result = irsim.benchmark(str(tmp_path / "full.yaml"), seeds=3)
    told = "3 of 3 seeds had no room and do not count (placement-crowded): 0, 1, 2"
    assert (result.rows, result.incidents) == ([], [told])
    done = CliRunner().invoke(app, ["benchmark", str(tmp_path / "full.yaml"), "--seeds", "3"])
    assert (done.exit_code, done.output.startswith(told[:24])) == (0, True)


def test_a_perturbed_start_without_room_says_so(tmp_path: Path) -> None:
    """A long robot in a narrow gap: almost no heading fits."""
    file = str(tmp_path / "gap.yaml")
    Path(file).write_text("""
world: {width: 20, height: 20, time_limit: 2}
robot: {name: train, kinematics: {name: diff}, state: [10, 10, 0], goal: [18, 10], behavior: {name: dash},
        shape: {name: rectangle, length: 12, width: 0.999}}
obstacle:
  - {number: 2, shape: {name: rectangle, length: 18, width: 1}, state: [[10, 11, 0], [10, 9, 0]]}
""")
    result = irsim.benchmark(file, seeds=5, perturb="heading=90deg")
    seed = next(episode.seed for episode in result.episodes if episode.outcome == "placement-crowded")
    with pytest.raises(irsim.PlacementError) as error:
        irsim.run(file, seed=seed, perturb="heading=90deg")
    [item] = error.value.diagnostics
    assert item.code == "placement-crowded"
    assert f"no room for 'train' with seed {seed}" in item.message
    assert "lower `position` or `heading` of perturb" in str(item.fix)
    done = CliRunner().invoke(app, ["run", file, "--seed", str(seed), "--perturb", "heading=90deg", "--json"])
    assert (done.exit_code, "placement-crowded" in json.dumps(json.loads(done.stdout))) == (2, True)
