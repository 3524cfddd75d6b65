"""Checks the rows of a submission: what its result says of the suite, that no episode is missing, and its tables."""

from __future__ import annotations

import math
from collections import Counter
from pathlib import Path

from irsim.api.audit.files import MAX_FILE_BYTES
from irsim.api.audit.problems import Problems, is_close
from irsim.api.audit.suite import Claim
from irsim.api.submission import table_of
from irsim.benchmarks.episode import environment_of
from irsim.benchmarks.log import with_episodes
from irsim.benchmarks.preparation import Prepared, prepare
from irsim.benchmarks.stored import RESULTS, result_of_plan
from irsim.benchmarks.submission import MANIFEST, ROWS, Manifest
from irsim.common.records import read_bytes
from irsim.diagnostics.errors import PlacementError
from irsim.policies.behavior import BehaviorPolicy
from irsim.results.benchmark import CROWDED, EpisodeRow, SuiteResult
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import MAX_STEPS

__all__ = ["check_episodes", "check_head", "check_table", "prepared_claim"]

_TOLERANCE = 1e-9
_ROWS = ("rows", "pairs", "ranks", "episodes", "incidents", "notes", "engine")
"""Keys of a result that follow from its episodes or are checked elsewhere."""
_OF_POLICIES = ("behaviors", "information", "digests", "unequal", "random", "certain", "warnings")
"""Keys that depend on the policies, all of which must be here to compute them."""


def prepared_claim(claim: Claim) -> Prepared:
    """The benchmark of a claim, prepared here with all policies that are here."""
    plan = claim.plan
    return prepare(
        {scenario.name: scenario.document() for scenario in plan.scenarios},
        list(claim.policies.values()) or [BehaviorPolicy(AS_WRITTEN)],
        plan.seeds,
        perturb=plan.perturb,
        until=plan.until,
        groups=plan.groups,
        parts=plan.parts(),
    )


def check_head(claim: Claim, ready: Prepared, result: SuiteResult, problems: Problems) -> None:
    """Whether everything that the result says besides its episodes follows from the suite and the policies."""
    known = result_of_plan(claim.plan, ready.head).model_dump()
    given = result.model_dump()
    for key, value in known.items():
        if key in _ROWS or (claim.missing and key in _OF_POLICIES):
            continue
        if not is_close(given[key], value, _TOLERANCE):
            what = f"its key {key} does not follow from the suite and the policies"
            problems.add("submission-rows", RESULTS, what, given=given[key], allowed=value)
    if not claim.missing:
        return
    listed = list(claim.plan.policies.values())
    if result.behaviors != listed:
        problems.add("submission-rows", RESULTS, "it has other behaviors than the plan", given=result.behaviors)
    for name in claim.missing:
        text = claim.plan.policies[name]
        if result.information.get(text):
            problems.note(f"what the policy {name} knows is what its author says: {result.information[text]}")


def check_episodes(claim: Claim, ready: Prepared, result: SuiteResult, manifest: Manifest, problems: Problems) -> None:
    """Whether each scenario, policy and seed has exactly one row, and only seeds without room are called so."""
    plan = claim.plan
    done = Counter((one.scenario, one.behavior, one.seed) for one in result.episodes)
    chances = dict(ready.head.random)
    if claim.missing:  # such a policy may read noisy scans, so that each seed is another episode
        chances = {name: parts or result.random.get(name, []) for name, parts in chances.items()}
    expected = {
        (scenario.name, policy, seed)
        for scenario in plan.scenarios
        for policy in plan.policies.values()
        for seed in (plan.seeds if chances.get(scenario.name) else plan.seeds[:1])
    }
    for scenario, policy, seed in sorted(expected - set(done)):
        problems.add("submission-rows", RESULTS, f"the episode {scenario}, {policy}, seed {seed} is missing")
    for scenario, policy, seed in sorted(set(done) - expected):
        problems.add("submission-rows", RESULTS, f"the suite has no episode {scenario}, {policy}, seed {seed}")
    for (scenario, policy, seed), number in done.items():
        if number > 1:
            problems.add("submission-rows", RESULTS, f"the episode {scenario}, {policy}, seed {seed} has {number} rows")
    if manifest.episodes != len(result.episodes):
        problems.add("submission-rows", MANIFEST, f"it counts {manifest.episodes} of {len(result.episodes)} episodes")
    _check_room(ready, result, problems)
    for one in result.episodes:
        if one.outcome != CROWDED and (why := _why_impossible(one, ready.head.step_time)) is not None:
            where = f"the episode {one.scenario}, {one.behavior}, seed {one.seed}"
            problems.add("submission-rows", RESULTS, f"{where} is impossible: {why}")


def _check_room(ready: Prepared, result: SuiteResult, problems: Problems) -> None:
    """Whether a seed leaves no room, which is asked for each scenario and seed of which a row says so."""
    tasks = {(scenario, task.seed): task for scenario, _, task in ready.plan}
    crowded = {(one.scenario, one.seed) for one in result.episodes if one.outcome == CROWDED}
    for scenario, seed in sorted(crowded & set(tasks)):
        task = tasks[scenario, seed]
        try:
            environment_of(task.job, task.seed).end(ending_time=0.0)
        except PlacementError:
            continue
        what = f"{scenario}, seed {seed}, is called {CROWDED}, and there is room for all objects: its episodes were run"
        problems.add("submission-rows", RESULTS, what)
    for one in result.episodes:
        if (one.scenario, one.seed) in crowded and one.outcome != CROWDED:
            what = f"{one.scenario}, seed {one.seed}, is {CROWDED} for one policy and {one.outcome} for {one.behavior}"
            problems.add("submission-rows", RESULTS, what)


def _why_impossible(one: EpisodeRow, periods: dict[str, float]) -> str | None:
    """Why no episode has such a row; None if one may have it."""
    period = periods.get(one.scenario)
    if period is None:
        return None
    if not 0 <= one.steps <= MAX_STEPS:
        return f"it has {one.steps:,} steps"
    if not math.isclose(one.sim_time, one.steps * period, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE):
        return f"{one.steps} steps of {period:g} s are not {one.sim_time:g} s"
    if one.sim_time > one.time_limit + _TOLERANCE:
        return f"it took {one.sim_time:g} s of {one.time_limit:g} s"
    success = one.metrics.get("success")
    if success is not None and (success == 1.0) != (one.outcome == "success"):
        return f"its outcome is {one.outcome}, and the share of its robots with success is {success:g}"
    return None


def check_table(folder: Path, claim: Claim, result: SuiteResult, problems: Problems) -> None:
    """Recompute every summary from the episodes, and the table of episodes."""
    try:
        again = with_episodes(result, result.episodes)
        table = table_of(result, {text: name for name, text in claim.plan.policies.items()})
    except (ValueError, ArithmeticError, LookupError, TypeError) as error:
        problems.add("submission-table", RESULTS, f"no table can be computed from its episodes ({error})")
        return
    for key in ("rows", "pairs", "ranks", "incidents", "notes"):
        given, known = (one.model_dump(include={key})[key] for one in (result, again))
        if not is_close(given, known, _TOLERANCE):
            problems.add("submission-table", RESULTS, f"its {key} do not follow from its episodes")
    if read_bytes(folder / ROWS, MAX_FILE_BYTES, follow=False) != table.encode():
        problems.add("submission-table", ROWS, f"it has other episodes or numbers than {RESULTS}")
