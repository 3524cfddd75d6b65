"""``irsim.benchmark``: fair, repeatable, the same on any number of processes."""

from __future__ import annotations

import csv
import io
import json
import math
import re
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import irsim
from irsim.benchmarks import AS_WRITTEN
from irsim.benchmarks.episode import Job, scenario_of
from irsim.benchmarks.labels import labels_of
from irsim.cli.app import app
from irsim.diagnostics.errors import BehaviorError, InputError, OverLimitError, ScenarioNotFoundError
from irsim.metrics import wilson
from irsim.policies import Observations
from irsim.results.benchmark import seeds_of
from irsim.scenario.behavior_override import parse_behavior

CROWD = """
world: {width: 8, height: 8, time_limit: 12}
robot:
  - kinematics: {name: diff}
    number: 3
    distribution: {name: random, range_low: [1, 1, -3], range_high: [7, 7, 3]}
    shape: {name: circle, radius: 0.2}
    behavior: {name: dash, wander: false, target_roles: all}
    goal: [4, 4, 0]
obstacle:
  - {shape: {name: circle, radius: 0.3}, state: [4, 6]}
"""
ALONE = "robot: {kinematics: {name: diff}, state: [1, 1, 0], goal: [5, 1, 0], behavior: {name: dash}}\n"


@pytest.fixture
def files(tmp_path):
    (tmp_path / "crowd.yaml").write_text(CROWD)
    (tmp_path / "alone.yaml").write_text(ALONE)
    return [str(tmp_path / "crowd.yaml"), str(tmp_path / "alone.yaml")]


def test_each_episode_equals_a_run_with_its_seed(files) -> None:
    result = irsim.benchmark(files, seeds=[4, 7])
    assert [(e.scenario, e.seed) for e in result.episodes] == [(files[0], 4), (files[0], 7), (files[1], 4)]
    for episode in result.episodes:
        alone = irsim.run(episode.scenario, seed=episode.seed)
        assert (episode.outcome, episode.steps) == (alone.outcome, alone.steps)
        assert (episode.time_limit, episode.sim_time) == (alone.time_limit, alone.sim_time)
        times = [robot.time_to_goal for robot in alone.robots if robot.time_to_goal is not None]
        mean = episode.metrics["time_to_goal"]
        assert mean == (pytest.approx(sum(times) / len(times)) if times else None)


@pytest.mark.parametrize(
    ("perturb", "episodes"), [(None, 14), (["position=0.5,heading=20deg", "speed=10%,delay=3,objects=robot"], 24)]
)
def test_results_do_not_depend_on_the_number_of_processes(files, at_once, perturb, episodes) -> None:
    told = []
    one = irsim.benchmark(files, ["rvo", "orca"], 6, workers=1, perturb=perturb)
    many = irsim.benchmark(
        files, ["rvo", "orca"], 6, workers=3, perturb=perturb, progress=lambda *now: told.append(now)
    )
    assert one.model_dump_json() == many.model_dump_json()
    assert (told, told[-1][1]) == (sorted(told), episodes)


def test_a_log_has_every_episode_from_the_moment_it_is_done(files, tmp_path) -> None:
    log, parts = tmp_path / "episodes.jsonl", []

    def read(*now: int) -> None:
        parts.append(irsim.benchmarks.logged(log))

    whole = irsim.benchmark(files, ["dash", "rvo"], 2, workers=1, log=log, progress=read)
    assert [len(part.episodes) for part in parts] == [1, 2, 3, 4, 5, 6]
    for part in parts:
        assert part.episodes == whole.episodes[: len(part.episodes)]
        assert sum(row.episodes for row in part.rows if row.scenario != "(all)") == len(part.episodes)
        assert (part.seeds, part.reproduce) == (whole.seeds, whole.reproduce)
    assert parts[-1].model_dump_json() == whole.model_dump_json()
    assert parts[2].rows[1].paired["path_length"].n == 1  # of the second behavior one seed is done


def test_a_log_is_in_order_for_any_number_of_processes_and_may_end_within_a_line(files, tmp_path, at_once) -> None:
    log = tmp_path / "episodes.jsonl"
    whole = irsim.benchmark(files, ["rvo", "orca"], 6, workers=3, log=log)
    assert irsim.benchmarks.logged(log).model_dump_json() == whole.model_dump_json()
    log.write_bytes(log.read_bytes()[:-7])
    part = irsim.benchmarks.logged(log)
    assert len(part.episodes) == len(whole.episodes) - 1
    order = [(episode.scenario, episode.behavior, episode.seed) for episode in part.episodes]
    assert order == [one for one in ((e.scenario, e.behavior, e.seed) for e in whole.episodes) if one in order]


def test_a_stopped_benchmark_has_equally_many_episodes_of_every_behavior(files, tmp_path) -> None:
    class Stopped(Exception):
        pass

    def stop(done: int, total: int) -> None:
        if done == 45:
            raise Stopped

    log = tmp_path / "episodes.jsonl"
    with pytest.raises(Stopped):
        irsim.benchmark(files[0], ["dash", "rvo", "orca"], 100, workers=1, log=log, progress=stop)
    part = irsim.benchmarks.logged(log)
    assert [row.episodes for row in part.rows] == [15, 15, 15]
    assert [row.paired["path_length"].n for row in part.rows[1:]] == [15, 15]


def test_a_file_that_is_not_a_log_is_an_error(files, tmp_path) -> None:
    for text in ("", "{}\n", "what\n", '{"number": 1}\n'):
        (tmp_path / "log").write_text(text)
        with pytest.raises(irsim.runs.RunError, match="is not a log of a benchmark"):
            irsim.benchmarks.logged(tmp_path / "log")
    with pytest.raises(irsim.runs.RunError, match="cannot be written: No such file"):
        irsim.benchmark(files, log=tmp_path / "no" / "log")


def test_behaviors_meet_the_same_scenes_and_are_compared_pair_by_pair(files) -> None:
    result = irsim.benchmark(files[0], ["dash", "{name: rvo, neighbor_threshold: 2}"], 5)
    dash, rvo = result.rows
    assert (dash.paired, dash.success.n, rvo.episodes) == ({}, 5, 5)
    assert result.behaviors == ["dash", "{name: rvo, neighbor_threshold: 2}"]
    lengths = {(e.behavior, e.seed): e.metrics["path_length"] for e in result.episodes}
    first, second = result.behaviors
    paired = rvo.paired["path_length"]
    mean = math.fsum(lengths[second, seed] - lengths[first, seed] for seed in range(5)) / 5
    assert paired.mean == pytest.approx(mean)
    assert paired.low <= paired.mean <= paired.high
    assert dash.success.count + dash.collision.count + dash.timeout.count == 5
    assert rvo.success.low <= rvo.success.rate <= rvo.success.high


def test_noise_that_no_policy_reads_is_not_chance() -> None:
    world = "world: {width: 10, height: 10}\n"
    robot = ALONE.replace("behavior", "sensors: [{name: lidar2d, number: 8, noise: true}], behavior")
    result = irsim.benchmark(world + robot, ["dash", "orca"], seeds=5)
    assert [len(result.episodes), "nothing is random that these policies notice" in result.notes[0]] == [2, True]

    def drive(seen: Observations) -> np.ndarray:
        return np.tile([1.0, 0.0], (len(seen), 1))

    assert len(irsim.benchmark(world + robot, ["dash", drive], seeds=5).episodes) == 10  # it may read anything
    foggy = world.replace("}", ", fog_map: true}") + robot
    assert len(irsim.benchmark(foggy, ["dash"], seeds=5).episodes) == 5  # the fog is lifted by what the lidar has seen


@pytest.mark.parametrize(
    ("keys", "policy"),
    [
        ({"perceives": "estimate", "sensors": [{"name": "localization", "position_std": 0.05}]}, "orca"),
        ({"sensors": [{"name": "lidar2d", "range_max": 4, "realism": {"dropout": 0.2}}]}, "goal_lidar"),
    ],
)
def test_errors_of_what_a_robot_decides_from_are_chance(keys, policy) -> None:
    robot = {"kinematics": {"name": "diff"}, "shape": {"name": "circle", "radius": 0.25}, "state": [1, 5, 0], **keys}
    post = {"shape": {"name": "circle", "radius": 0.4}, "state": [5, 5.2, 0]}
    world = {"width": 10, "height": 10, "time_limit": 20}
    text = json.dumps({"world": world, "robot": [{**robot, "goal": [9, 5]}], "obstacle": [post]}, indent=1)
    one, other = irsim.benchmark(text, [policy], seeds=2).episodes
    assert one.metrics["path_length"] != other.metrics["path_length"]


def test_a_behavior_that_draws_random_numbers_runs_with_every_seed(files) -> None:
    result = irsim.benchmark(files[1], ["dash", "avocado"], seeds=3)
    [note] = result.notes
    assert [len(result.episodes), [row.success.n for row in result.rows]] == [6, [1, 3]]
    assert note.endswith("nothing random reaches dash: all seeds give one episode, which counts once")


def test_a_scenario_without_randomness_runs_once_and_a_note_says_so(files) -> None:
    result = irsim.benchmark(files[1], seeds=20)
    assert len(result.episodes) == 1
    assert "nothing is random" in result.notes[0]
    [row] = result.rows
    assert (row.success.rate, row.success.low, row.success.high) == (1.0, None, None)  # it can't come out differently
    [_, other] = irsim.benchmark(files[1], ["dash", "rvo"], 20).rows
    assert (other.paired["success"].mean, other.paired["success"].low) == (0.0, None)


def test_scenarios_that_weigh_the_same_are_also_taken_together(files, tmp_path) -> None:
    (tmp_path / "other.yaml").write_text(CROWD.replace("number: 3", "number: 2"))
    both = [files[0], str(tmp_path / "other.yaml")]
    result = irsim.benchmark(both, seeds=3)
    assert [(row.scenario, row.episodes) for row in result.rows] == [(both[0], 3), (both[1], 3), ("(all)", 6)]
    assert [row.scenario for row in irsim.benchmark(files, seeds=3).rows] == files  # three episodes and one
    fixed = [str(tmp_path / f"fixed-{number}.yaml") for number in range(10)]
    for number, file in enumerate(fixed):
        Path(file).write_text(ALONE.replace("[5, 1, 0]", f"[5, {number / 10}, 0]"))
    assert len(irsim.benchmark(fixed[:9]).rows) == 9  # unlike scenes, one run each
    assert irsim.benchmark(fixed).rows[-1].scenario == "(all)"


def test_rows_name_the_seeds_and_robots_that_failed(files) -> None:
    result = irsim.benchmark(files[0], seeds=range(100, 110))
    [row] = result.rows
    ends = {e.seed: e.outcome for e in result.episodes}
    for outcome in ("collision", "timeout"):
        assert row.failed.get(outcome, []) == [seed for seed, end in ends.items() if end == outcome]
    assert row.collision.count  # dash drives into others
    for episode in result.episodes:
        assert bool(episode.failures) == (episode.outcome != "success")
        told = irsim.run(files[0], seed=episode.seed).robots
        assert set(episode.failures) == {robot.name for robot in told if robot.outcome != "success"}
    assert max(row.failures.values()) <= 10
    assert any(what.startswith("'robot_0': collision with ") for what in row.failures)


def test_pairs_that_all_agree_are_no_certainty(files) -> None:
    result = irsim.benchmark(files[0], ["dash", "{name: dash, wander: false}"], 10)
    for key in ("success", "collision", "timeout"):
        both = result.rows[1].paired[key]
        assert (both.mean, both.low < -0.05, both.high > 0.05) == (0.0, True, True)
    assert result.rows[1].paired["path_length"].low == 0.0


def test_metrics_that_are_zero_or_one_have_intervals_of_shares(files) -> None:
    [row] = irsim.benchmark(files[0], "dash", 10).rows
    for key, share in (("success", row.success), ("timeout", row.timeout), ("collision", row.collision)):
        assert (row.metrics[key].low, row.metrics[key].high) == (share.low, share.high)
    for key in ("goal_reached", "left_world"):
        estimate = row.metrics[key]
        assert (estimate.low, estimate.high) == pytest.approx(wilson(round(estimate.mean * 10), 10))
    [fixed] = irsim.benchmark(files[1], seeds=20).rows
    assert (fixed.metrics["goal_reached"].low, fixed.metrics["goal_reached"].high) == (None, None)


WALLED = """
world: {width: 8, height: 8, time_limit: 2}
robot:
  {kinematics: {name: diff}, shape: {name: circle, radius: 0.2}, state: [1, 4], goal: [7, 4], behavior: {name: dash}}
obstacle:
  - {shape: {name: rectangle, length: 0.5, width: 9}, state: [4, 4]}
  - {shape: {name: circle, radius: 0.1}, distribution: {name: random, range_low: [5, 1, 0], range_high: [7, 2, 0]}}
"""


def test_where_there_is_no_way_spl_is_undefined_and_said(tmp_path) -> None:
    file = str(tmp_path / "walled.yaml")
    Path(file).write_text(WALLED)
    result = irsim.benchmark(file, seeds=5)
    [row] = result.rows
    assert (row.timeout.count, row.metrics["spl"].n, row.metrics["spl"].mean) == (5, 0, None)
    assert [episode.unreachable for episode in result.episodes] == [1] * 5
    assert "spl is left out" in result.notes[0]
    shown = CliRunner().invoke(app, ["benchmark", file, "--seeds", "5"]).output
    [line] = [line.split() for line in shown.splitlines() if line.startswith("walled ")]
    assert line[-1] == "-"


def test_the_table_says_of_how_many_episodes_a_mean_is(files) -> None:
    arguments = ["benchmark", files[0], "--behaviors", "dash,rvo", "--seeds", "10"]
    rows = irsim.benchmark(files[0], ["dash", "rvo"], 10).rows
    times = [row.metrics["time_to_goal"].n for row in rows]
    assert 0 < times[0] < 10
    shown = CliRunner().invoke(app, arguments).output
    lines = [line for line in shown.splitlines() if re.search(r"(dash|rvo) +10 ", line)]
    assert [f"({n})" in line for n, line in zip(times, lines, strict=True)] == [n < 10 for n in times]
    assert "only 5 of the n episodes have this value" in shown
    pairs = rows[1].paired["time_to_goal"].n
    assert f"] ({pairs})" in next(line for line in shown.splitlines() if "same seeds" in line)


def test_long_behaviors_have_short_labels() -> None:
    long, other = (f"{{name: orca, timeHorizon: {seconds}}}" for seconds in (2, 3))
    assert labels_of(["rvo", long, other]) == {"rvo": "rvo", long: "orca #2", other: "orca #3"}
    told = seeds_of({"collision": [7], "timeout": [18, 23, 32]}, 2)
    assert told == "collision: seed 7; timeout: seeds 18, 23 and 1 more"


def job(text: str, behavior: str) -> Job:
    return Job(text, None, behavior, None, True, (), ())


def test_robots_keep_their_tasks_under_another_behavior() -> None:
    text = "robot:\n  - {kinematics: {name: diff}, number: 2, group_behavior: {name: orca, timeHorizon: 3}}\n"
    text += "  - {kinematics: {name: omni}, behavior: {name: dash, wander: true, range_high: [3, 3]}}\n"
    text += "  - {shape: {name: circle}}\nobstacle: {kinematics: {name: omni}, behavior: {name: sfm}, state: [5, 5]}\n"
    records = scenario_of(job(text, "rvo")).objects
    assert [r.behavior and r.behavior.name for r in records] == ["rvo", "rvo", "rvo", None, "sfm"]
    assert [r.group_behavior for r in records] == [None] * 5
    assert (records[2].wander, records[2].range_high[:2]) == (True, [3, 3])
    assert scenario_of(job(text, "orca")).objects[0].behavior.timeHorizon == 20  # a bare name has its defaults
    assert scenario_of(job(text, AS_WRITTEN)).objects[0].group_behavior.name == "orca"


@pytest.mark.parametrize("wrong", ["", "a b", "{name: 3}", "{timeHorizon: 5}", "{name: [", "name: orca"])
def test_text_that_is_not_a_behavior_is_refused(wrong) -> None:
    with pytest.raises(InputError, match="bad-argument"):
        parse_behavior(wrong)


def test_invalid_comparisons_are_refused_before_anything_runs(files, tmp_path) -> None:
    with pytest.raises(OverLimitError, match="2 scenarios x 3 policies x 100 seeds = 600 episodes"):
        irsim.benchmark(files, ["rvo", "orca", "sfm"], 100, most_episodes=500)
    for given, message in (
        ({"policies": "rov"}, "did you mean rvo"),
        ({"files": [files[0], files[0]]}, "given twice"),
        ({"seeds": 0}, "at least one seed"),
        ({"seeds": [-1]}, "must be from 0 to"),
    ):
        with pytest.raises(InputError, match=message):
            irsim.benchmark(**{"files": files, **given})
    with pytest.raises(ScenarioNotFoundError):
        irsim.benchmark([*files, str(tmp_path / "none.yaml")])
    for strict in (True, False):  # no file of IR-SIM has such an argument
        with pytest.raises(InputError, match="'timeHorizn' is not a key of behavior orca") as error:
            irsim.benchmark(files, ["dash", "{name: orca, timeHorizn: 5}"], strict=strict)
        assert error.value.where == "policies[1]"


def test_an_episode_that_fails_is_raised_as_it_is(files, at_once) -> None:
    @irsim.register_behavior("diff", "breaks_here")
    def breaks(ego_object, external_objects, **kwargs):
        return None

    with pytest.raises(BehaviorError, match="'breaks_here' of 'robot_0' returned None"):
        irsim.benchmark(files[0], "breaks_here", 4, workers=2)


def test_a_behavior_that_only_this_program_knows(files, at_once) -> None:
    @irsim.register_behavior("diff", "creep_along_here")
    def creep(ego_object, external_objects, **kwargs):
        return [[0.1], [0.0]]

    result = irsim.benchmark(files[0], "creep_along_here", 4, workers=2)
    assert [episode.seed for episode in result.episodes] == [0, 1, 2, 3]
    assert [episode.metrics["velocity_max"] for episode in result.episodes] == pytest.approx([0.1] * 4)


def test_a_job_crosses_a_process_unchanged() -> None:
    job = Job("text", "a.yaml", "rvo", 5, True, ("module",), (("root", None), ("steps", 3)))
    assert Job.of_data(json.loads(json.dumps(asdict(job)))) == job


def test_the_command(files) -> None:
    runner = CliRunner()
    shown = runner.invoke(app, ["benchmark", *files, "--behaviors", "dash,{name: rvo, vxmax: 1}", "--seeds", "3"])
    assert shown.exit_code == 0, shown.output
    assert all(part in shown.output for part in ("same seeds", "failed: crowd, dash: collision: seed"))
    assert "rvo #2" not in shown.output
    assert re.search(r"\('\w+': collision with '\w+' \d of 3", shown.output)
    told = re.search(r"failed: crowd, dash: collision: seeds? (\d+)", shown.output)
    assert told is not None
    alone = runner.invoke(app, ["benchmark", *files, "--policies", "dash", "--seeds", f"{told[1]}-{told[1]}"]).output
    assert re.search(rf"failed: crowd, dash: collision: seed {told[1]} \('\w+': collision with '\w+'[,)]", alone)
    assert "1 of 1" not in alone
    told = runner.invoke(app, ["benchmark", files[0], "--behaviors", "dash,rvo", "--seeds", "2-4", "--json"])
    same = irsim.benchmark(files[0], ["dash", "rvo"], [2, 3, 4])
    assert told.stdout.rstrip("\n") == same.model_dump_json()
    assert same.reproduce == f"irsim benchmark {files[0]} --policies dash,rvo --seeds 2-4"
    told = runner.invoke(app, ["benchmark", *files, "--csv", "--seeds", "1,3"]).stdout
    table = list(csv.DictReader(io.StringIO(told)))
    assert [row["seed"] for row in table] == ["1", "3", "1"]
    assert float(table[2]["path_length"]) > 3
    assert table[0]["distance_to_human_min"] == ""
    for wrong in (["--seeds", "x"], ["--seeds", "9-2"], ["--seeds", "0"], ["--json", "--csv"], ["--behaviors", ","]):
        assert runner.invoke(app, ["benchmark", files[0], *wrong]).exit_code == 2


@pytest.mark.parametrize(
    ("policies", "said"),
    [
        (["dash", "orca"], None),
        (["dash", "sfm"], "drives at most 2 m/s under dash, 1.5 m/s under sfm; equal speeds need vmax of sfm or a"),
        (["{name: follow, local: {name: rvo}}", "{name: orca, maxSpeed: 1}"], "1 m/s under {name: orca, maxSpeed: 1}"),
        (["{name: rvo, vxmax: 2, vymax: 2}", "dash"], "turns at most 1.5 rad/s under {name: rvo, vxmax: 2, vymax: 2}"),
        (["as-written", "random"], None),
    ],
)
def test_a_note_says_in_one_sentence_which_limits_of_the_policies_are_unequal(tmp_path, policies, said) -> None:
    file = tmp_path / "fast.yaml"
    fast = ALONE.replace("behavior:", "vel_max: [2, 3], vel_min: [-2, -3], name: scout, behavior:")
    file.write_text("world: {time_limit: 1}\n" + fast)
    result = irsim.benchmark([str(file)], policies, seeds=1)
    (*_, note) = [*result.notes, ""] if said is None else result.notes
    assert result.unequal == ({} if said is None else {str(file): note.removeprefix(f"{file}: ")})
    if said is not None:
        assert note.startswith(f"{file}: limits are unequal, so times are not fair: 'scout' ")
        assert said in note
        assert ". " not in note.removeprefix(str(file))
