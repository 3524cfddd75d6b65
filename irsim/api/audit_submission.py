"""Checks a submission: its manifest and hashes, that no episode is missing, its table, and its recorded episodes."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from pydantic import ValidationError

from irsim.api.submission import table_of
from irsim.benchmarks.log import with_episodes
from irsim.benchmarks.plan import Plan
from irsim.benchmarks.stored import EPISODES, PLAN, RESULTS, read_plan
from irsim.benchmarks.submission import MANIFEST, ROWS, RUNS, Manifest, sampled_episodes
from irsim.benchmarks.suite import SUITES
from irsim.benchmarks.suite_plan import suite_plan
from irsim.benchmarks.summary import is_summary
from irsim.common.hashing import file_digest
from irsim.common.installed import version
from irsim.common.records import ContentError, read_bytes, read_json
from irsim.common.text import clean
from irsim.diagnostics.errors import IrsimError
from irsim.results.audit import AuditResult, LeaderboardRow, RunAudit, SubmissionAudit
from irsim.results.benchmark import CROWDED, EpisodeRow, SuiteResult
from irsim.results.findings import Finding
from irsim.runs.audit.audit import audit_runs
from irsim.runs.files import json_of, text_of
from irsim.runs.store import META, SCENARIO_FILE

__all__ = ["audit_all", "audit_submission"]

_MAX_FILES = 2000
_MAX_FILE_BYTES = 512 * 1024**2
_MAX_LISTED = 50
_TOLERANCE = 1e-9
_AGAIN = "write the submission again: irsim benchmark SUITE --submission DIR"


def audit_all(names: Sequence[str | Path]) -> AuditResult:
    """Audit recorded runs and submissions.

    Args:
        names: Each a run, see :func:`irsim.runs.audit.audit.audit_runs`, or the folder of a submission.
    """
    submissions = [name for name in names if (Path(name) / MANIFEST).exists()]
    runs = audit_runs([name for name in names if name not in submissions]).runs
    checked = [audit_submission(name) for name in submissions]
    results: list[RunAudit | SubmissionAudit] = [*runs, *checked]
    odd = sum(not result.equal for result in results)
    summary = f"{len(results) - odd} of {len(results)} are equal to their recomputation"
    if len(results) == 1:
        summary = results[0].summary
    return AuditResult(equal=not odd, summary=summary, runs=runs, submissions=checked)


class _Problems:
    """The problems of a submission."""

    def __init__(self) -> None:
        self.listed = list[Finding]()
        self.count = 0

    def add(self, code: str, path: str, message: str, *, given: Any = None, allowed: str | None = None) -> None:
        """Add a problem with a file."""
        self.count += 1
        if len(self.listed) < _MAX_LISTED:
            self.listed.append(
                Finding(code=code, severity="error", path=clean(path, 200), line=None, column=None,
                        message=clean(message, 400), given=given, allowed=allowed, fix=_AGAIN)
            )  # fmt: skip


def audit_submission(folder: str | Path) -> SubmissionAudit:
    """Check a submission that :func:`irsim.api.submission.write_submission` has written.

    Everything that is wrong becomes a problem with the path of its file; nothing of the folder is executed, and no
    link is followed.

    Args:
        folder: The folder.
    """
    place, problems = Path(folder), _Problems()
    manifest = _manifest(place, problems)
    result: SuiteResult | None = None
    runs, sampled, part = list[RunAudit](), 0, ""
    if manifest is not None and _files_are_whole(place, manifest, problems):
        plan = _plan(place, manifest, problems)
        result = _result(place, problems) if plan is not None else None
        if plan is not None and result is not None:
            part = _check_suite(plan, problems)
            _check_episodes(plan, result, manifest, problems)
            _check_table(place, plan, result, problems)
            runs, sampled = _check_runs(place, plan, result, manifest, problems)
    name, equal = clean(str(folder), 200), not problems.count
    episodes = 0 if result is None else len(result.episodes)
    first = problems.listed[0] if problems.listed else None
    summary = f"{name}: {episodes} episodes; {sampled} of them, recorded, are equal to their rows{part}"
    if first is not None:
        summary = f"{name}: {problems.count} problems; the first: {first.path}: {first.message}"
    return SubmissionAudit(
        folder=name, equal=equal, summary=summary, episodes=episodes, sampled=sampled, problems=problems.listed,
        problem_count=problems.count, runs=runs,
        leaderboard=_leaderboard(result) if result is not None and equal else [],
    )  # fmt: skip


def _manifest(folder: Path, problems: _Problems) -> Manifest | None:
    try:
        data = read_json(read_bytes(folder / MANIFEST, follow=False), unique=True)
        return Manifest.model_validate(data)
    except ContentError as error:
        problems.add("bad-submission", MANIFEST, f"it cannot be read: {error.message}")
    except ValidationError:
        problems.add("bad-submission", MANIFEST, "it has other keys or values than irsim writes")
    return None


def _files_are_whole(folder: Path, manifest: Manifest, problems: _Problems) -> bool:
    """Whether every file of the manifest is there with its digest, and no other file lies among the recorded runs."""
    before = problems.count
    if len(manifest.files) > _MAX_FILES:
        problems.add("bad-submission", MANIFEST, f"it lists {len(manifest.files)} files", allowed=f"up to {_MAX_FILES}")
        return False
    for name in (PLAN, EPISODES, RESULTS, ROWS):
        if name not in manifest.files:
            problems.add("submission-file", name, "the manifest does not list it")
    for name, known in manifest.files.items():
        if (why := _why_odd(folder, name)) is not None:
            problems.add("submission-file", name, why)
        elif file_digest(folder / name) != known:
            problems.add("submission-file", name, "its SHA-256 is not the one of the manifest: it was changed")
    for path in sorted((folder / RUNS).rglob("*"))[: 2 * _MAX_FILES]:
        name = path.relative_to(folder).as_posix()
        if (path.is_symlink() or not path.is_dir()) and name not in manifest.files:
            problems.add("submission-file", name, "the manifest does not list it")
    return problems.count == before


def _why_odd(folder: Path, name: str) -> str | None:
    """Why a path of the manifest is not read; None if it is an ordinary file of the folder."""
    path = PurePosixPath(name)
    if (
        path.is_absolute()
        or "\\" in name
        or ":" in name
        or "\0" in name
        or any(part in ("..", "") for part in path.parts)
    ):
        return "it does not name a file within the folder"
    step = folder
    for part in path.parts:
        step = step / part
        if step.is_symlink():
            return "it is a link, or lies behind one"
    if not step.is_file():
        return "it is missing, or no ordinary file"
    if step.stat().st_size > _MAX_FILE_BYTES:
        return f"it is larger than {_MAX_FILE_BYTES} bytes"
    return None


def _plan(folder: Path, manifest: Manifest, problems: _Problems) -> Plan | None:
    try:
        plan = read_plan(folder)
    except IrsimError:
        problems.add("bad-submission", PLAN, "it is not the plan of a benchmark")
        return None
    if plan.suite is None:
        problems.add("bad-submission", PLAN, "it is not the plan of a suite")
        return None
    facts: dict[str, tuple[object, object]] = {
        "plan_hash": (manifest.plan_hash, plan.hash),
        "suite": (manifest.suite, plan.suite.suite),
        "suite_version": (manifest.suite_version, plan.suite.version),
        "suite_hash": (manifest.suite_hash, plan.suite_hash),
        "irsim": (manifest.irsim, plan.version),
        "seeds": (manifest.seeds, plan.seeds),
        "policies": (sorted(manifest.policies), sorted({*plan.policies, *plan.digests})),
    }
    for key, (given, known) in facts.items():
        if given != known:
            problems.add("bad-submission", MANIFEST, f"{key} is not the one of {PLAN}", given=str(given)[:200])
    for name, digest in plan.digests.items():
        if manifest.policies.get(name) != digest:
            problems.add("bad-submission", MANIFEST, f"the hash of the policy {name} is not the one of {PLAN}")
    return plan


def _result(folder: Path, problems: _Problems) -> SuiteResult | None:
    try:
        content = read_bytes(folder / RESULTS, _MAX_FILE_BYTES, follow=False)
        return SuiteResult.model_validate(read_json(content), strict=False)
    except ContentError as error:
        problems.add("bad-submission", RESULTS, f"it cannot be read: {error.message}")
    except ValidationError:
        problems.add("bad-submission", RESULTS, "it has other keys or values than irsim writes")
    return None


def _check_suite(plan: Plan, problems: _Problems) -> str:
    """Compare the scenarios with the bundled suite, if this version has it; returns what part of it was run."""
    assert plan.suite is not None
    if plan.suite.suite not in SUITES.names() or plan.version != version():
        return f"; irsim {version()} cannot check the scenarios: it has no {plan.suite.suite} of irsim {plan.version}"
    own = suite_plan(plan.suite.suite)
    if own.suite_hash != plan.suite_hash:
        problems.add("submission-rows", PLAN, f"the suite is not {plan.suite.suite} of irsim {version()}",
                     given=plan.suite_hash, allowed=own.suite_hash)  # fmt: skip
    scenes = {scenario.name: (scenario.text, scenario.policies) for scenario in own.scenarios}
    for scenario in plan.scenarios:
        if scenes.get(scenario.name) != (scenario.text, scenario.policies):
            problems.add("submission-rows", PLAN, f"the suite has no such scenario {scenario.name}")
    if plan.until != own.until or plan.steps != own.steps or plan.perturb != own.perturb:
        problems.add("submission-rows", PLAN, "episodes end otherwise, or are perturbed otherwise, than in the suite")
    whole = len(plan.scenarios) == len(own.scenarios) and set(own.seeds) <= set(plan.seeds)
    if whole:
        return ""
    return f"; a part of the suite: {len(plan.scenarios)} of {len(own.scenarios)} scenarios, {len(plan.seeds)} seeds"


def _check_episodes(plan: Plan, result: SuiteResult, manifest: Manifest, problems: _Problems) -> None:
    """Whether each scenario, policy and seed has exactly one row."""
    done = Counter((one.scenario, one.behavior, one.seed) for one in result.episodes)
    expected = {
        (scenario.name, policy, seed)
        for scenario in plan.scenarios
        for policy in plan.policies.values()
        for seed in (plan.seeds if result.random.get(scenario.name) else plan.seeds[:1])
    }
    for scenario, policy, seed in sorted(expected - set(done)):
        problems.add("submission-rows", RESULTS, f"the episode {scenario}, {policy}, seed {seed} is missing")
    for scenario, policy, seed in sorted(set(done) - expected):
        problems.add("submission-rows", RESULTS, f"the plan has no episode {scenario}, {policy}, seed {seed}")
    for (scenario, policy, seed), number in done.items():
        if number > 1:
            problems.add("submission-rows", RESULTS, f"the episode {scenario}, {policy}, seed {seed} has {number} rows")
    if manifest.episodes != len(result.episodes):
        problems.add("submission-rows", MANIFEST, f"it counts {manifest.episodes} of {len(result.episodes)} episodes")


def _check_table(folder: Path, plan: Plan, result: SuiteResult, problems: _Problems) -> None:
    """Recompute every summary from the episodes, and the table of episodes."""
    try:
        again = with_episodes(result, result.episodes)
        table = table_of(result, {text: name for name, text in plan.policies.items()})
    except (ValueError, ArithmeticError, LookupError, TypeError) as error:
        problems.add("submission-table", RESULTS, f"no table can be computed from its episodes ({error})")
        return
    for key in ("rows", "pairs", "ranks", "incidents", "notes"):
        given, known = (one.model_dump(include={key})[key] for one in (result, again))
        if not _same(given, known):
            problems.add("submission-table", RESULTS, f"its {key} do not follow from its episodes")
    if read_bytes(folder / ROWS, _MAX_FILE_BYTES, follow=False) != table.encode():
        problems.add("submission-table", ROWS, f"it has other episodes or numbers than {RESULTS}")


def _same(given: Any, known: Any) -> bool:
    """Whether two values are equal up to rounding."""
    if isinstance(given, dict) and isinstance(known, dict):
        return given.keys() == known.keys() and all(_same(given[key], known[key]) for key in given)
    if isinstance(given, (list, tuple)) and isinstance(known, (list, tuple)):
        return len(given) == len(known) and all(map(_same, given, known))
    if isinstance(given, float) and isinstance(known, float):
        return math.isclose(given, known, rel_tol=_TOLERANCE, abs_tol=_TOLERANCE)
    return bool(given == known)


def _check_runs(
    folder: Path, plan: Plan, result: SuiteResult, manifest: Manifest, problems: _Problems
) -> tuple[list[RunAudit], int]:
    """Audit the recorded episodes and compare them with their rows; returns the odd audits, and how many were made."""
    names = {text: name for name, text in plan.policies.items()}
    rows = {(one.scenario, names.get(one.behavior, ""), one.seed): one for one in result.episodes}
    expected = sampled_episodes(plan.hash, [key for key, row in rows.items() if row.outcome != CROWDED])
    given = [(one.scenario, one.policy, one.seed) for one in manifest.sample]
    if given != expected:
        problems.add("submission-run", MANIFEST, "its sample is not the one that the hash of the plan decides")
        return [], 0
    odd, sampled = list[RunAudit](), 0
    texts = {scenario.name: scenario.text for scenario in plan.scenarios}
    for one, key in zip(manifest.sample, expected, strict=True):
        if f"{one.folder}/{META}" not in manifest.files:
            problems.add("submission-run", one.folder, "the manifest does not list the files of this recorded episode")
            continue
        place = folder / one.folder
        [audit] = audit_runs([place]).runs
        for problem in audit.problems:
            problems.add(problem.code, one.folder, problem.message)
        if audit.finding_count:
            problems.add("submission-run", one.folder, f"its audit differs: {audit.findings[0].message}")
            odd.append(audit)
        if audit.problems:
            continue
        sampled += 1
        _check_origin(place, one.folder, texts[one.scenario], one.seed, problems)
        for what, recorded, recomputed in _differences(rows[key], audit, plan.until == "first_collision"):
            message = f"{what} of the row of {', '.join(map(str, key))} is not the one of the recorded episode"
            problems.add("submission-run", one.folder, message, given=recorded, allowed=f"{recomputed}")
    return odd, sampled


def _check_origin(place: Path, name: str, text: str, seed: int, problems: _Problems) -> None:
    """Whether a recorded run is of the scenario and the seed."""
    meta = json_of(place, META)
    if not isinstance(meta, dict) or meta.get("seed") != seed or text_of(place, SCENARIO_FILE) != text:
        problems.add("submission-run", name, "it is the record of another scenario or seed")


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


def _leaderboard(result: SuiteResult) -> list[LeaderboardRow]:
    """A row for each policy and summary; for each scenario where there is no summary."""
    names = {text: name for name, text in result.policies.items()}
    wide = [row for row in result.rows if is_summary(row.scenario)]
    return [
        LeaderboardRow(
            suite=f"{result.suite} {result.suite_version} ({result.suite_hash})", scenes=row.scenario,
            policy=names.get(row.behavior, row.behavior), episodes=row.episodes, success=row.success.rate,
            low=row.success.low, high=row.success.high, collision=row.collision.rate,
            time_to_goal=row.metrics["time_to_goal"].mean,
        )
        for row in wide or result.rows
    ]  # fmt: skip
