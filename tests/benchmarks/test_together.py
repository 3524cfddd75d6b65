"""Episodes of several seeds, stepped together, have the results that they have one by one."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import irsim
from irsim.benchmarks import together
from irsim.benchmarks.episode import Job, Task, run_task
from irsim.benchmarks.together import run_together, worlds_at_once
from irsim.diagnostics.errors import OverLimitError
from irsim.policies.catalog import open_policy
from irsim.policies.networks import save_network
from tests.policies.networks.examples import crowd, filled

CROWD = """
world: {width: 8, height: 8, step_time: 0.1, time_limit: 12}
robot:
  - number: 3
    kinematics: {name: diff, noise: true}
    distribution: {name: random, range_low: [0.5, 0.5, -3], range_high: [7.5, 7.5, 3]}
    shape: {name: polygon, random_shape: true, avg_radius_range: [0.1, 0.4]}
    sensors: [{name: lidar2d, number: 20, noise: true}]
obstacle:
  - number: PEOPLE
    kinematics: {name: omni}
    distribution: {name: random, range_low: [0.5, 0.5, -3], range_high: [7.5, 7.5, 3]}
    shape: {name: circle, radius: 0.5}
    behavior: {name: sfm}
"""


def job(text: str = CROWD, people: int = 4, until: str = "done", behavior: str = "orca") -> Job:
    return Job(text.replace("PEOPLE", str(people)), None, behavior, None, False, (), (), until)  # type: ignore[arg-type]


def assert_equal(job: Job, seeds: list[int]) -> list[str]:
    """Compare both ways of running, digit by digit; returns the outcomes."""
    alone = [run_task(Task(job, seed)) for seed in seeds]
    assert [json.dumps(result) for result in run_together(job, seeds)] == [json.dumps(result) for result in alone]
    return [result["outcome"] for result in alone]


@pytest.mark.parametrize("until", ["done", "first_collision"])
def test_results_are_those_of_single_episodes(until: str) -> None:
    assert len(set(assert_equal(job(until=until), [3, 11, 4, 8, 100]))) > 1


def test_seeds_without_room_are_named_and_the_others_run() -> None:
    outcomes = assert_equal(job(people=36), list(range(6, 14)))
    assert {"placement-crowded"} < set(outcomes)


def test_horizons_that_depend_on_the_scene() -> None:
    text = CROWD.replace(", time_limit: 12", "").replace("width: 8, height: 8", "width: 80, height: 80")
    text = text.replace("7.5, 7.5", "79, 79")
    assert_equal(job(text, behavior="dash"), [0, 1, 2])


def test_few_worlds_at_a_time_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = [json.dumps(result) for result in run_together(job(), list(range(5)))]
    monkeypatch.setattr(together, "_MAX_TRACE_BYTES", 75 * 7 * 120 * 2)
    assert worlds_at_once(7, 120) == 2
    assert [json.dumps(result) for result in run_together(job(), list(range(5)))] == expected


def test_python_behaviors_run_one_by_one_with_the_same_results() -> None:
    @irsim.register_behavior("diff", "creep")  # type: ignore[untyped-decorator]
    def creep(ego_object: object, external_objects: object, **_: object) -> object:
        return [0.1, 0.2]

    assert_equal(job(behavior="creep"), [1, 2])


def test_limits_hold_for_every_episode() -> None:
    limited = Job(CROWD.replace("PEOPLE", "2"), None, "orca", 100, False, (), (("steps", 50),))
    with pytest.raises(OverLimitError):
        list(run_together(limited, [1, 2]))


@pytest.mark.parametrize("policy", ["random", "network"])
def test_policies_in_python_decide_for_many_worlds_as_they_do_for_one(policy: str, tmp_path: Path) -> None:
    source = policy
    if policy == "network":
        source = str(tmp_path / "net.npz")
        save_network(source, filled(crowd()))
    opened = open_policy(source)
    made = replace(job(behavior="as-written"), policy=opened.source, digest=opened.digest)
    alone = [run_task(Task(made, seed)) for seed in range(5)]
    decided = [len(result.pop("decisions")) for result in alone]
    results = list(run_together(made, list(range(5))))
    assert ["decisions" in result for result in results] == [True, False, False, False, False], "one alone, to be timed"
    assert len(results[0].pop("decisions")) == decided[0]
    assert [json.dumps(result) for result in results] == [json.dumps(result) for result in alone]
