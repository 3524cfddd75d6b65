"""Policies in benchmarks: fair, resumable, named in results; their times are kept apart."""

from __future__ import annotations

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import irsim
from irsim.api.benchmark_report import write_report
from irsim.benchmarks.plan import file_plan
from irsim.benchmarks.stored import resume_benchmark, run_plan
from irsim.benchmarks.suite import Suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.benchmarks.timing import timing_report
from irsim.diagnostics.errors import InputError, PolicyError
from irsim.policies import Observations, Policy
from irsim.runs.files import RunError

SCENE = """
world: {width: 10, height: 10, time_limit: 3}
robot:
  - number: 2
    kinematics: {name: omni}
    distribution: {name: random, range_low: [1, 1, -3], range_high: [9, 9, 3]}
    behavior: {name: dash}
"""
FIXED = """
world: {time_limit: 2}
robot: {kinematics: {name: omni}, state: [1, 1, 0], goal: [2, 1], behavior: {name: dash}}
"""


class Creep(Policy):
    """A network whose file holds its speed."""

    output = "velocity"

    def __init__(self, path: Path) -> None:
        self.name, self.speed = path.stem, float(path.read_text())

    def act(self, observations: Observations) -> Any:
        return self.speed * (observations.goal - observations.pose)[:, :2]


@pytest.fixture(autouse=True)
def networks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    module = ModuleType("irsim.policies.networks")
    module.open_network = Creep  # type: ignore[attr-defined]
    monkeypatch.setitem(__import__("sys").modules, "irsim.policies.networks", module)
    monkeypatch.chdir(tmp_path)
    Path("scene.yaml").write_text(SCENE)
    Path("net.npz").write_text("0.7")


def to_goal(observations: Observations) -> Any:
    return 0.7 * (observations.goal - observations.pose)[:, :2]


def test_every_kind_of_policy_is_compared_on_any_number_of_processes() -> None:
    function = irsim.policies.FunctionPolicy(to_goal, output="velocity")
    result = irsim.benchmark(SCENE, ["dash", "random", "net.npz", function], 3, workers=1)
    in_python = ["dash", "random", function]  # a stand-in for files is known to this process only
    assert irsim.benchmark(SCENE, in_python, 3, workers=2) == irsim.benchmark(SCENE, in_python, 3, workers=1)
    assert result.behaviors == ["dash", "random", "net.npz", "to_goal"]
    assert list(result.digests) == ["net.npz"]
    assert result.reproduce == "irsim benchmark scenario.yaml --policies dash,random,net.npz,to_goal --seeds 3"
    by_policy = {row.behavior: row for row in result.rows}
    assert by_policy["random"].success.count == 0
    assert by_policy["net.npz"].metrics["path_length"] == by_policy["to_goal"].metrics["path_length"]


def test_behaviors_is_another_name_of_policies() -> None:
    assert irsim.benchmark(FIXED, behaviors="dash") == irsim.benchmark(FIXED, "dash")
    with pytest.raises(ValueError, match="two names of one argument"):
        irsim.benchmark(FIXED, "dash", behaviors="dash")
    with pytest.raises(InputError, match="unknown-policy") as error:
        irsim.benchmark(FIXED, ["dash", "dahs"])
    assert error.value.where == "policies[1]"


def test_a_policy_that_draws_runs_with_every_seed() -> None:
    result = irsim.benchmark(FIXED, ["dash", "net.npz"], 4)
    assert (result.random, len(result.episodes)) == ({"(text)": []}, 2)
    result = irsim.benchmark(FIXED, ["dash", "random"], 4)
    assert (result.random, len(result.episodes)) == ({"(text)": ["policy"]}, 8)
    assert len({episode.metrics["path_length"] for episode in result.episodes if episode.behavior == "random"}) == 4


def test_what_does_not_fit_is_refused_before_any_episode() -> None:
    wrong = irsim.policies.FunctionPolicy(to_goal, drives=frozenset({"diff"}))
    with pytest.raises(PolicyError, match="policy-mismatch") as error:
        irsim.benchmark(SCENE, ["dash", wrong], 2)
    assert error.value.where == "policies[1]"


def test_times_are_in_a_file_of_their_own() -> None:
    plan = file_plan(["scene.yaml"], ["dash", "net.npz"], "2")
    for folder in ("one", "two"):
        run_plan(plan, Path(folder), workers=1)
    times = json.loads(Path("one/timing.json").read_text())["policies"]
    assert (times["dash"]["episodes"], times["dash"]["episodes_in_all"]) == (1, 2)  # one is run again, phase by phase
    assert times["dash"]["per_robot"]["mean_ms"] > 0
    assert times["net.npz"]["episodes"] == times["net.npz"]["episodes_in_all"] == 2
    assert times["net.npz"]["robots_per_decision"] == 2.0
    assert times["net.npz"]["per_decision"]["p95_ms"] > 0
    for name in ("plan.json", "results.json", "episodes.jsonl"):
        text = Path("one", name).read_text()
        assert text == Path("two", name).read_text()
        assert not any(word in text for word in ("_ms", "seconds", "timing", "decisions"))


def test_times_are_summarised_by_decision_and_by_robot() -> None:
    report = timing_report({"net": {"0": [(0.001, 1), (0.004, 2)]}, "later": {}}, dict.fromkeys(["net", "later"], 3))
    counts = {"episodes": 1, "episodes_in_all": 3, "decisions": 2, "robots_per_decision": 1.5}
    times = {"per_decision": {"mean_ms": 2.5, "p95_ms": 3.85}, "per_robot": {"mean_ms": 1.66667, "p95_ms": 2.0}}
    assert report["policies"]["net"] == {**counts, **times}
    assert "resumed" in report["policies"]["later"]["reason"]


def test_a_changed_file_is_another_benchmark() -> None:
    plan = file_plan(["scene.yaml"], ["net.npz"], "2")
    run_plan(plan, Path("out"), workers=1)
    assert plan.digests["net.npz"] in Path("out/plan.json").read_text()
    Path("net.npz").write_text("0.5")
    with pytest.raises(PolicyError, match=r"other-benchmark: the file of policy 'net.npz' has changed"):
        resume_benchmark(Path("out"))
    other = file_plan(["scene.yaml"], ["net.npz"], "2")
    assert other.hash != plan.hash
    with pytest.raises(RunError, match="other-benchmark"):
        run_plan(other, Path("out"), resume=True)


def test_plans_without_files_keep_their_hash_and_folders_do_not_matter(tmp_path: Path) -> None:
    plain = file_plan(["scene.yaml"], ["dash"], "2")
    assert plain.hash == plain.model_copy(update={"sources": {"dash": "/somewhere"}}).hash
    plan = file_plan(["scene.yaml"], ["net.npz"], "2")
    assert plan.hash == plan.model_copy(update={"sources": {"net.npz": "/other/net.npz"}}).hash


def test_suites_name_files_beside_them(tmp_path: Path) -> None:
    folder = tmp_path / "suites"
    folder.mkdir()
    (folder / "inner.npz").write_text("0.6")
    text = """
    suite: own
    version: 1
    title: A network beside its suite
    scenarios: [{name: fixed, scenario: {robot: {kinematics: {name: omni}, state: [1, 1, 0], goal: [2, 1]}}}]
    seeds: {count: 1}
    steps: 50
    policies: {network: inner.npz, mapped: {name: inner.npz}, dash: dash}
    """
    (folder / "own.yaml").write_text(text)
    plan = suite_plan(str(folder / "own.yaml"))
    assert set(plan.digests) == {"network", "mapped"}
    result = run_plan(plan, Path("out"), workers=1)
    assert [row.success.count for row in result.rows] == [1, 1, 1]
    also = suite_plan(str(folder / "own.yaml"), policies=["network", "net.npz"])
    assert also.policies == {"network": "inner.npz", "net.npz": "net.npz"}
    assert isinstance(plan.suite, Suite)


def test_reports_show_episodes_of_policies() -> None:
    Path("net.npz").write_text("0.01")
    Path("of mine").mkdir()
    Path("of mine/net.npz").write_text("0.02")
    policies = [str(Path("of mine/net.npz").resolve()), "net.npz"]
    result = run_plan(file_plan(["scene.yaml"], policies, "1"), Path("out"), workers=1)
    assert "net.npz" in write_report(result, Path("out")).page.read_text()
    assert len(list(Path("out/replays").glob("*net.npz-0.html"))) == 2
