"""One episode of a suite again, by its name: ``irsim run SUITE/SCENARIO --seed N`` is what the suite has measured."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import irsim
from irsim import api
from irsim.benchmarks.episode import Job, Task, environment_of, run_task
from irsim.benchmarks.policies import job_keys
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.suite import SUITES
from irsim.benchmarks.suite_plan import suite_plan
from irsim.runs import open_run
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.simulation.trace import record

_SEEDS = (0, 1)
"""Numbers of the episodes, from the first seed of a suite on."""


@pytest.mark.parametrize("suite", SUITES.names())
def test_a_scenario_of_a_suite_runs_as_the_suite_runs_it(suite: str, tmp_path: Path) -> None:
    """With the same bits: perturbed, and to the same end."""
    name = next(iter(suite_plan(suite).policies))
    plan = suite_plan(suite, policies=[name])
    (policy,) = plan.opened()
    chosen = plan.scenarios[:: max(1, len(plan.scenarios) // 3)][:3]
    for scenario in chosen:
        for number in _SEEDS:
            seed = plan.seeds[number]
            job = Job(
                text=scenario.text, path=scenario.document().path, steps=plan.steps, strict=plan.strict, imports=(),
                limits=tuple(vars(DEFAULT_LIMITS).items()), perturb=tuple(plan.perturb), until=plan.until,
                **job_keys(shared_with(policy, plan.parts().get(scenario.name, {}))),
            )  # fmt: skip
            measured = run_task(Task(job, seed))
            folder = tmp_path / f"{scenario.name.replace('/', '-')}-{seed}"
            result = irsim.run(f"{suite}/{scenario.name}", seed=seed, policy=name, record=folder)
            assert (result.outcome, result.steps) == (measured["outcome"], measured["steps"])
            trace = record(environment_of(job, seed).simulation, measured["steps"])
            again = open_run(folder).trace()
            assert np.array_equal(again.pose, trace.pose, equal_nan=True)
            kept = trace.control.astype(np.float32)  # as records hold controls
            assert np.array_equal(again.control.astype(np.float32), kept)
            assert (result.perturb, result.until) == (plan.perturb, plan.until)


def test_what_a_suite_adds_can_be_left_out(tmp_path: Path) -> None:
    name = next(f"circle_swap_v1/{one.name}" for one in suite_plan("circle_swap_v1").scenarios)
    plain, own = (irsim.run(name, seed=3, policy="dash", **more) for more in ({"perturb": []}, {}))
    assert (plain.perturb, own.perturb) == ([], ["position=0.1"])
    assert plain.robots[0].pose != own.robots[0].pose
    other = irsim.run(name, seed=3, policy="dash", perturb="position=0.2", until="done")
    assert (other.perturb, other.until) == (["position=0.2"], "done")


def test_an_episode_that_ends_at_a_collision_can_be_asked_for(tmp_path: Path) -> None:
    file = tmp_path / "crash.yaml"
    file.write_text(
        "world: {width: 10, height: 6, time_limit: 20}\n"
        "robot:\n"
        "  - &one {kinematics: {name: diff}, state: [1, 1], goal: [9, 1], behavior: {name: dash},\n"
        "          shape: {name: circle, radius: 0.2}}\n"
        "  - {<<: *one, state: [1, 4], goal: [9, 4]}\n"
        "obstacle: {shape: {name: circle, radius: 0.3}, state: [3, 1]}\n"
    )
    whole, cut = (irsim.run(file, until=until) for until in ("done", "first_collision"))
    assert whole.robots[1].outcome == "success"
    assert cut.robots[1].outcome == "timeout"
    assert cut.steps == min(event.step for event in whole.events if event.kind == "collision")


def test_the_picture_of_a_scenario_of_a_suite_is_of_its_perturbed_start() -> None:
    name = next(f"circle_swap_v1/{one.name}" for one in suite_plan("circle_swap_v1").scenarios)
    start = irsim.run(name, seed=3, steps=0)
    shown = api.snapshot(name, seed=3, draw=False)
    assert [robot.pose for robot in shown.robots] == [robot.pose for robot in start.robots]
