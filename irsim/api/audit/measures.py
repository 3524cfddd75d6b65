"""Measures recorded episodes of a submission again: each value of a row must follow from its record."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from irsim.api.audit.problems import flat, is_close
from irsim.benchmarks.comparison import episode_row
from irsim.benchmarks.episode import Episode, Job, Task, environment_of, measure
from irsim.benchmarks.plan import Plan, PlannedScenario
from irsim.benchmarks.policies import job_keys
from irsim.episodes.episode import horizon_of
from irsim.policies.policy import Policy
from irsim.results.benchmark import EpisodeRow
from irsim.runs.reading import open_run
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import DEFAULT_LIMITS

__all__ = ["job_of", "measured_differences"]

_TOLERANCE = 1e-6
"""Relative difference that counts as rounding: recorded controls have single precision."""
_NOT_RECORDED = ("lost", "metrics pedestrian_delay", "metrics explored")
"""Values that do not follow from a record: both metrics need the world after the end of the episode."""


def job_of(scenario: PlannedScenario, plan: Plan, policy: Policy | None) -> Job:
    """The job of a scenario under a policy; None drives the robots as they are written, to draw the scene."""
    keys: Mapping[str, Any] = {"behavior": AS_WRITTEN} if policy is None else job_keys(policy)
    return Job(
        text=scenario.text, path=scenario.document().path, steps=plan.steps, strict=plan.strict, imports=(),
        limits=tuple(vars(DEFAULT_LIMITS).items()), perturb=tuple(plan.perturb), until=plan.until, **keys,
    )  # fmt: skip


def measured_differences(record: Path, row: EpisodeRow, job: Job, *, roles: bool) -> list[tuple[str, Any, Any]]:
    """Measure a recorded episode, and compare it with its row.

    Args:
        record: The recorded run.
        row: Its row.
        job: Its scenario and policy.
        roles: Whether metrics by role are compared, too, which needs the policy.

    Returns:
        Name, value of the row and measured value of all that differ.

    Raises:
        RunError: The record cannot be read.
        ValueError, ArithmeticError, LookupError, TypeError: Nothing can be computed from its numbers.
    """
    run, task = open_run(record), Task(job, row.seed)
    env = environment_of(job, row.seed)
    horizon, _ = horizon_of(env.simulation, job.steps, DEFAULT_LIMITS)
    episode = Episode(run.trace(), run.events, horizon, lost="recorded")  # so that nothing goes on after its end
    measured = measure(task, episode, env, env.simulation)
    env.end(ending_time=0.0)
    known, given = flat(episode_row(row.scenario, row.behavior, task, measured).model_dump()), flat(row.model_dump())
    names = [name for name in sorted({*known, *given}) if name not in _NOT_RECORDED]
    compared = [name for name in names if roles or not name.startswith("roles")]
    pairs = [(name, given.get(name), known.get(name)) for name in compared]
    return [(name, mine, theirs) for name, mine, theirs in pairs if not is_close(mine, theirs, _TOLERANCE)]
