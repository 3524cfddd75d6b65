"""Audits the recorded episodes of a submission: each must begin as the suite does, and have the numbers of its row."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from irsim.api.audit.measures import job_of, measured_differences
from irsim.api.audit.problems import Problems, is_close
from irsim.api.audit.suite import Claim
from irsim.benchmarks.episode import environment_of
from irsim.benchmarks.plan import Plan, PlannedScenario
from irsim.benchmarks.roles import shared_with
from irsim.benchmarks.submission import MANIFEST, Manifest, SampledEpisode, sample_seed, sampled_episodes
from irsim.diagnostics.errors import IrsimError
from irsim.episodes.episode import horizon_of
from irsim.episodes.run_report import RunPlan
from irsim.policies.behavior import BehaviorPolicy
from irsim.policies.policy import Policy
from irsim.results.audit import RunAudit
from irsim.results.benchmark import CROWDED, EpisodeRow, SuiteResult
from irsim.runs.audit.artifact import Artifact, read_artifact
from irsim.runs.audit.audit import audit_runs
from irsim.runs.files import json_of, text_of
from irsim.runs.recorder import recording
from irsim.runs.store import META, SCENARIO_FILE
from irsim.scenario.behavior_override import AS_WRITTEN
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.simulation.engine import engine

__all__ = ["check_records", "named_engine", "rows_of"]

_TOLERANCE = 1e-9
"""Greatest difference of a start that is drawn again on another system."""
_SETUP = ("seed", "horizon", "step_time", "options", "names", "sensors", "scans", "trace_until", "scans_until",
          "cancelled", "scenario")  # fmt: skip
"""Keys of ``run.json`` that are compared with a record that is begun again."""


def rows_of(claim: Claim, result: SuiteResult) -> dict[tuple[str, str, int], EpisodeRow]:
    """The rows by scenario, name of the policy and seed."""
    names = {text: name for name, text in claim.plan.policies.items()}
    return {(one.scenario, names.get(one.behavior, ""), one.seed): one for one in result.episodes}


def named_engine(manifest: Manifest) -> str:
    """Words about the engine that a submission names, to follow a difference; empty if it is this engine."""
    return "" if manifest.engine == engine() else f" (it names engine {manifest.engine}, and this is {engine()})"


def check_records(
    folder: Path, claim: Claim, result: SuiteResult, manifest: Manifest, problems: Problems
) -> tuple[list[RunAudit], set[tuple[str, str, int]]]:
    """Audit the recorded episodes, and compare them with their rows.

    Returns:
        The audits that differ, and scenario, policy and seed of the records that could be read.
    """
    rows = rows_of(claim, result)
    done = [key for key, row in rows.items() if row.outcome != CROWDED]
    expected = sampled_episodes(sample_seed(claim.plan), done)
    given = [(one.scenario, one.policy, one.seed) for one in manifest.sample]
    if given != expected:
        problems.add("submission-run", MANIFEST, "its sample is not the one that suite, policies and seeds decide")
        return [], set()
    odd, sampled = list[RunAudit](), set[tuple[str, str, int]]()
    for one, key in zip(manifest.sample, expected, strict=True):
        if f"{one.folder}/{META}" not in manifest.files:
            problems.add("submission-run", one.folder, "the manifest does not list the files of this recorded episode")
            continue
        [audit] = audit_runs([folder / one.folder]).runs
        for problem in audit.problems:
            problems.add(problem.code, one.folder, problem.message)
        if audit.finding_count:
            problems.add("submission-run", one.folder, f"its audit differs: {audit.findings[0].message}")
            odd.append(audit)
        if audit.problems:
            continue
        sampled.add(key)
        by = named_engine(manifest)
        for what, recorded, known in _origin(folder / one.folder, one, claim, manifest):
            problems.add("submission-origin", one.folder, what + by, given=recorded, allowed=known)
        for what, recorded, known in _differences(rows[key], audit, claim.plan.until == "first_collision"):
            message = f"{what} of the row of {', '.join(map(str, key))} is not the one of the recorded episode"
            problems.add("submission-run", one.folder, message, given=recorded, allowed=known)
        _check_measures(folder, one, rows[key], claim, problems)
    return odd, sampled


def _check_measures(folder: Path, one: SampledEpisode, row: EpisodeRow, claim: Claim, problems: Problems) -> None:
    """Whether each value of a row follows from its record."""
    scenario = next(scenario for scenario in claim.plan.scenarios if scenario.name == one.scenario)
    policy = claim.policies.get(claim.plan.policies[one.policy])
    shared = None if policy is None else shared_with(policy, claim.plan.parts().get(one.scenario, {}))
    try:
        job = job_of(scenario, claim.plan, shared)
        odd = measured_differences(folder / one.folder, row, job, roles=policy is not None)
    except (IrsimError, ValueError, ArithmeticError, LookupError, TypeError) as error:
        problems.add("submission-run", one.folder, f"nothing can be measured in this record ({error})")
        return
    if odd:
        more = f" and {len(odd) - 1} other values" if len(odd) > 1 else ""
        what = f"{odd[0][0]}{more} of the row of {one.scenario}, {one.policy}, seed {one.seed} differ from the record"
        problems.add("submission-run", one.folder, what, given=odd[0][1], allowed=odd[0][2])


def _origin(place: Path, one: SampledEpisode, claim: Claim, manifest: Manifest) -> Iterator[tuple[str, Any, Any]]:
    """The differences between the beginning of a record and the suite: message, recorded and drawn value."""
    scenario = next(scenario for scenario in claim.plan.scenarios if scenario.name == one.scenario)
    if text_of(place, SCENARIO_FILE) != scenario.text:
        yield f"it is not a record of the scenario {one.scenario}", None, None
        return
    with tempfile.TemporaryDirectory() as begun:
        policy = claim.policies.get(claim.plan.policies[one.policy])
        try:
            _begin(scenario, one, claim.plan, policy, Path(begun) / "run")
        except IrsimError as error:
            yield f"the scene {one.scenario}, seed {one.seed}, cannot be drawn: {error}", None, None
            return
        yield from _compare(place, Path(begun) / "run", manifest)


def _begin(scenario: PlannedScenario, one: SampledEpisode, plan: Plan, policy: Policy | None, target: Path) -> None:
    """Begin the record of an episode: everything that it holds before the first step."""
    shared = None if policy is None else shared_with(policy, plan.parts().get(scenario.name, {}))
    env = environment_of(job_of(scenario, plan, shared), one.seed)
    horizon, source = horizon_of(env.simulation, plan.steps, DEFAULT_LIMITS)
    behavior = shared.text if isinstance(shared, BehaviorPolicy) else None
    setup = RunPlan(
        None, horizon, source, strict=plan.strict, behavior=None if behavior == AS_WRITTEN else behavior,
        policy=None if behavior is not None else shared, perturb=plan.perturb, until=plan.until,
    ).record_options()  # fmt: skip
    if shared is None:
        setup |= {"policy": plan.policies[one.policy], "policy_digest": plan.digests.get(one.policy)}
    with recording(env.simulation, None, target, horizon=horizon, options=setup):
        pass
    env.end(ending_time=0.0)


def _compare(given: Path, known: Path, manifest: Manifest) -> Iterator[tuple[str, Any, Any]]:
    """The differences between the beginnings of two records."""
    meta, own = json_of(given, META), json_of(known, META)
    program = {"irsim": manifest.irsim, "engine": manifest.engine, "python": manifest.python, "numpy": manifest.numpy}
    for key, value in {**{key: own[key] for key in _SETUP if key != "scenario"}, **program}.items():
        if not is_close(meta.get(key), value, _TOLERANCE):
            yield f"it was recorded with another {key}", meta.get(key), value
    recorded, drawn = (_scene_of(json_of(place, "resolved.json")) for place in (given, known))
    if (odd := _first_difference(recorded, drawn)) is not None:
        yield f"its scene is not the one of the scenario and the seed: {odd[0]} in resolved.json", odd[1], odd[2]
        return
    yield from _compare_start(read_artifact(given), read_artifact(known))


def _scene_of(data: dict[str, Any]) -> dict[str, Any]:
    """The scene of a record without its name, which depends on the folder that it was recorded from."""
    data["name"] = None
    return data


def _compare_start(given: Artifact, known: Artifact) -> Iterator[tuple[str, Any, Any]]:
    """The differences between the first recorded steps, and between the cells of the maps."""
    if given.first != 0:
        yield "its trace does not begin at the start", given.first, 0
        return
    if given.result is None:
        yield "it has no result: the episode did not end", None, None
    for name in ("pose", "goal", "control"):
        mine, theirs = getattr(known, name)[0], getattr(given, name)[0]
        odd = ~np.isclose(theirs, mine, rtol=_TOLERANCE, atol=_TOLERANCE, equal_nan=True).all(axis=1)
        if odd.any():
            row = int(np.argmax(odd))
            what = f"the {name} of {known.names[row]} at the start is not the one of the scenario and the seed"
            yield what, theirs[row].tolist(), mine[row].tolist()
    if (given.cells is None) != (known.cells is None) or (
        given.cells is not None
        and known.cells is not None
        and not all(np.array_equal(mine, theirs) for mine, theirs in zip(known.cells, given.cells, strict=True))
    ):
        yield "its map has other cells than the map of the scenario", None, None


def _first_difference(given: Any, known: Any, path: str = "") -> tuple[str, Any, Any] | None:
    """The first place at which plain data differ by more than rounding: path, given and known value."""
    if isinstance(given, dict) and isinstance(known, dict) and given.keys() == known.keys():
        pairs = [(f"{path}.{key}" if path else key, given[key], known[key]) for key in known]
    elif isinstance(given, list) and isinstance(known, list) and len(given) == len(known):
        pairs = [(f"{path}[{place}]", a, b) for place, (a, b) in enumerate(zip(given, known, strict=True))]
    elif isinstance(given, (dict, list)) or isinstance(known, (dict, list)):
        return path, "other keys" if isinstance(given, dict) else given, None
    else:
        return None if is_close(given, known, _TOLERANCE) else (path, given, known)
    return next((odd for where, a, b in pairs if (odd := _first_difference(a, b, where)) is not None), None)


def _differences(row: EpisodeRow, audit: RunAudit, first: bool) -> list[tuple[str, Any, Any]]:
    """Values of a row that differ from the audit of its record: name, value of the row, recomputed value."""
    robots = audit.robots
    ends = [robot.outcome for robot in robots]
    outcome = "timeout"
    if "collision" in ends or (first and any(robot.contacts for robot in robots)):
        outcome = "collision"
    elif ends and all(end == "success" for end in ends):
        outcome = "success"
    times = [robot.time_to_goal for robot in robots if robot.time_to_goal is not None]
    gaps = [robot.min_clearance for robot in robots if robot.min_clearance is not None]
    lengths = [robot.path_to_goal for robot in robots]
    values: dict[str, tuple[Any, Any]] = {
        "outcome": (row.outcome, outcome),
        "steps": (row.steps, audit.steps),
        "time_to_goal": (row.metrics.get("time_to_goal"), sum(times) / len(times) if times else None),
        "path_length": (row.metrics.get("path_length"), sum(lengths) / len(lengths) if lengths else None),
        "min_clearance": (row.metrics.get("min_clearance"), min(gaps) if gaps else None),
    }
    return [(key, given, known) for key, (given, known) in values.items() if not _close(given, known)]


def _close(given: Any, known: Any) -> bool:
    if isinstance(given, float) and isinstance(known, (float, int)):
        return math.isclose(given, known, rel_tol=1e-6, abs_tol=1e-6)
    return bool(given == known)
