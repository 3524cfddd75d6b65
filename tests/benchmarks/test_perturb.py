"""Benchmarks with perturbations: fixed scenes become random, everything says how, every episode can be looked at."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

import irsim
from irsim.benchmarks import BenchmarkError
from irsim.cli.app import app
from irsim.results.benchmark import BenchmarkResult
from irsim.runs import open_run
from irsim.runs.resimulation import check_reproduced, resimulate

CROSSING = """
world: {width: 10, height: 10, time_limit: 25}
robot:
  - {name: scout, kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 5, 0], goal: [9, 5],
     behavior: {name: dash}}
obstacle:
  - {name: walker, kinematics: {name: omni}, shape: {name: circle, radius: 0.3}, state: [5, 1, 0], goal: [5, 9],
     behavior: {name: dash}, tags: [pedestrian]}
"""


@pytest.fixture
def crossing(tmp_path: Path) -> str:
    (tmp_path / "crossing.yaml").write_text(CROSSING)
    return str(tmp_path / "crossing.yaml")


def test_a_fixed_scene_becomes_random(crossing: str) -> None:
    plain = irsim.benchmark(crossing, seeds=8)
    assert (len(plain.episodes), plain.rows[0].success.low) == (1, None)
    assert "perturb would make seeds differ" in plain.notes[0]
    log = Path(crossing).with_name("log")
    result = irsim.benchmark(crossing, seeds=8, perturb={"position": 0.5, "delay": 3}, log=log)
    assert [episode.seed for episode in result.episodes] == list(range(8))
    assert len({episode.metrics["path_length"] for episode in result.episodes}) == 8
    assert {episode.outcome for episode in result.episodes} == {"success", "collision"}
    assert result.rows[0].success.low is not None
    assert result.random[crossing] == ["start positions", "start delays"]
    said = "start ±0.5 m in x and in y, start delayed by 0 to 3 s of 'scout', 'walker'"
    assert (result.perturb, result.perturbed) == (["position=0.5,delay=3"], {crossing: [said]})
    assert result.notes == [f"perturbed, drawn uniformly for each seed: {said}"]
    assert result.reproduce == f"irsim benchmark {crossing} --seeds 8 --perturb position=0.5,delay=3"
    assert irsim.benchmarks.logged(log).model_dump_json() == result.model_dump_json()
    assert BenchmarkResult.model_validate_json(result.model_dump_json()) == result


def test_spread_zero_is_the_scenario_as_written(crossing: str) -> None:
    zero = irsim.benchmark(crossing, seeds=8, perturb="position=0,heading=0,speed=0,delay=0")
    plain = irsim.benchmark(crossing, seeds=8)
    assert (zero.episodes, zero.rows) == (plain.episodes, plain.rows)


def test_behaviors_meet_the_same_starts(crossing: str) -> None:
    result = irsim.benchmark(crossing, ["dash", "{name: dash, wander: false}"], 6, perturb="position=0.5,speed=0.2")
    assert [e.metrics for e in result.episodes[:6]] == [e.metrics for e in result.episodes[6:]]
    assert result.rows[1].paired["time_to_goal"].mean == 0.0


def test_each_episode_is_what_the_command_for_one_run_gives(crossing: str, tmp_path: Path) -> None:
    spreads = ["position=0.5,heading=0.2", "speed=10%,delay=3,objects=walker"]
    result = irsim.benchmark(crossing, ["as-written", "orca"], [3, 7], perturb=spreads)
    for episode in result.episodes:
        changed = None if episode.behavior == "as-written" else episode.behavior
        alone = irsim.run(crossing, seed=episode.seed, behavior=changed, perturb=spreads)
        assert (alone.outcome, alone.steps) == (episode.outcome, episode.steps)
        assert alone.robots[0].time_to_goal == episode.metrics["time_to_goal"]
        words = shlex.split(alone.reproduce)
        assert words[2:5] == [crossing, "--seed", str(episode.seed)]
        again = CliRunner().invoke(app, [*words[1:], "--json"])
        assert json.loads(again.stdout) == json.loads(alone.model_dump_json())
    again = CliRunner().invoke(app, [*shlex.split(result.reproduce)[1:], "--json"])
    assert again.stdout.rstrip("\n") == result.model_dump_json()


def test_a_seed_without_a_given_one_is_drawn_and_reported(crossing: str) -> None:
    assert irsim.run(crossing).random == []
    result = irsim.run(crossing, perturb="position=0.5")
    assert result.random == ["start positions"]
    assert f"--seed {result.seed} --perturb position=0.5" in result.reproduce


def test_a_recorded_run_is_simulated_again_as_it_was(crossing: str, tmp_path: Path) -> None:
    irsim.run(crossing, seed=5, perturb="position=0.5,speed=0.3,delay=2", record=tmp_path / "run")
    run = open_run(tmp_path / "run")
    env = resimulate(run)
    check_reproduced(run, env)
    start = run.trace().pose[0, 0]
    assert 0 < abs(start[0] - 1) < 0.5


def test_the_default_time_limit_leaves_time_for_the_delay(tmp_path: Path) -> None:
    (tmp_path / "far.yaml").write_text(CROSSING.replace(", time_limit: 25", ""))
    plain = irsim.run(tmp_path / "far.yaml").time_limit
    assert irsim.run(tmp_path / "far.yaml", seed=1, perturb="delay=40").time_limit == pytest.approx(plain + 40)


def test_what_still_waits_at_the_end_is_said(crossing: str) -> None:
    result = irsim.run(crossing, seed=1, steps=20, perturb="delay=20,objects=scout")
    assert result.reason is not None
    assert "'scout' still waits 8.00 m from its goal (its start is delayed to " in result.reason


def test_pedestrians_without_robots_start_as_late(crossing: str) -> None:
    """The delay of people compares the same starts with and without the robot: here no robot is in the way."""
    (Path(crossing)).write_text(CROSSING.replace("goal: [9, 5]", "goal: [2, 5]"))
    result = irsim.benchmark(crossing, seeds=5, perturb="position=0.3,speed=0.3,delay=4")
    assert [episode.metrics["pedestrian_delay"] for episode in result.episodes] == [0.0] * 5


def test_the_command_says_what_was_perturbed(crossing: str) -> None:
    run = CliRunner()
    words = ["benchmark", crossing, "--seeds", "4", "--perturb", "position=0.1", "--perturb", "heading=0.2,delay=1"]
    shown = run.invoke(app, words).output
    spread = "start ±0.1 m in x and in y, heading ±0.2 rad, start"
    assert f"note: perturbed, drawn uniformly for each seed: {spread}" in shown
    assert "--perturb position=0.1 --perturb heading=0.2,delay=1" in shown
    told = run.invoke(app, [*words, "--json"])
    same = irsim.benchmark(crossing, seeds=4, perturb=["position=0.1", {"heading": 0.2, "delay": 1}])
    assert told.stdout.rstrip("\n") == same.model_dump_json()


def test_wrong_perturbations_are_errors_as_data(crossing: str, tmp_path: Path) -> None:
    for verb in ("benchmark", "run"):
        done = CliRunner().invoke(app, [verb, crossing, "--perturb", "posiion=1,speed=3", "--json"])
        error = json.loads(done.stdout)["error"]
        assert (done.exit_code, error["code"]) == (2, "bad-argument")
        assert "did you mean position?" in error["message"]
        assert "speed must be a share" in error["message"]
    (tmp_path / "other.yaml").write_text(CROSSING.replace("walker", "runner"))
    with pytest.raises(BenchmarkError, match="no object of 'other' has the name, tag or role 'walker'"):
        irsim.benchmark([crossing, str(tmp_path / "other.yaml")], perturb="delay=1,objects=walker")
