"""Checks a submission: files, suite, rows, table and records; and runs a sample of its episodes again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from irsim.api.audit.files import check_log, files_are_whole, read_manifest, read_plan, read_result
from irsim.api.audit.problems import Problems
from irsim.api.audit.records import check_records
from irsim.api.audit.replay import DEFAULT_REPLAYS, Replay, replay_episodes
from irsim.api.audit.rows import check_episodes, check_head, check_table, prepared_claim
from irsim.api.audit.suite import Claim, claim_of
from irsim.benchmarks.stored import RESULTS
from irsim.benchmarks.submission import MANIFEST, Manifest
from irsim.benchmarks.summary import is_summary
from irsim.common.arguments import check_whole_number
from irsim.common.text import clean
from irsim.diagnostics.errors import InputError, IrsimError
from irsim.episodes.episode import Progress
from irsim.results.audit import AuditResult, LeaderboardRow, RunAudit, SubmissionAudit
from irsim.results.benchmark import SuiteResult
from irsim.runs.audit.audit import audit_runs
from irsim.runs.store import META, is_run
from irsim.simulation.engine import engine

__all__ = ["DEFAULT_REPLAYS", "audit_all", "audit_submission"]


def audit_all(names: Sequence[str | Path], **options: Any) -> AuditResult:
    """Audit recorded runs and submissions.

    Args:
        names: Each a run, see :func:`irsim.runs.audit.audit.audit_runs`, or the folder of a submission.
        **options: Further arguments of :func:`audit_submission`.

    Raises:
        InputError: A folder holds nothing that can be audited, or options of submissions are given without a
            submission.
    """
    submissions = [name for name in names if (Path(name) / MANIFEST).exists()]
    for name in names:
        if name not in submissions and Path(name).is_dir() and not is_run(name):
            what = f"{clean(str(name), 200)} holds neither a submission ({MANIFEST}) nor a recorded run ({META})"
            how = "irsim benchmark SUITE --submission DIR writes the one, irsim run FILE --record-to DIR the other"
            raise InputError(what, f"name such a folder: {how}")
    if not submissions and any(
        value is not None and value != {} for key, value in options.items() if key != "progress"
    ):
        what = "episodes are run again of submissions, and none of the folders is one"
        raise InputError(what, "name a folder made by irsim benchmark SUITE --submission DIR")
    runs = audit_runs([name for name in names if name not in submissions]).runs
    checked = [audit_submission(name, **options) for name in submissions]
    results: list[RunAudit | SubmissionAudit] = [*runs, *checked]
    odd = sum(not result.equal for result in results)
    summary = f"{len(results) - odd} of {len(results)} are equal to their recomputation"
    if len(results) == 1:
        summary = results[0].summary
    return AuditResult(equal=not odd, summary=summary, runs=runs, submissions=checked)


def audit_submission(
    folder: str | Path,
    *,
    replay: int | Literal["all"] | None = None,
    salt: str | None = None,
    policies: Mapping[str, str | Path] | None = None,
    suite: str | Path | None = None,
    workers: int | None = None,
    progress: Progress | None = None,
) -> SubmissionAudit:
    """Check a submission that :func:`irsim.api.submission.write_submission` has written.

    Everything that is wrong becomes a problem with the path of its file. Scenarios, seeds and policies are taken from
    this installation: nothing of the folder is executed, and no link is followed.

    Args:
        folder: The folder.
        replay: Number of episodes that are run again, or ``all``; None runs none.
        salt: Text that draws these episodes; the same text draws the same ones. Default: a new random text.
        policies: Name of a policy in the results -> its file, of policies that are files and not in the folder.
        suite: File of the suite, if it is not a bundled one.
        workers: Greatest number of processes; default: the number of cores.
        progress: Callback ``(episodes_done, episodes_total)`` of the episodes that are run again.

    Raises:
        InputError: An argument is not valid, or the suite cannot be read.
    """
    if replay is not None and replay != "all":
        replay = check_whole_number("replay", replay, 1)
    if replay is None and salt is not None:
        raise InputError("salt draws the episodes that are run again, which replay asks for", "give replay, too")
    place, problems = Path(folder), Problems()
    manifest = read_manifest(place, problems)
    result: SuiteResult | None = None
    claim: Claim | None = None
    runs, records, again = list[RunAudit](), set[tuple[str, str, int]](), Replay()
    if manifest is not None and files_are_whole(place, manifest, problems):
        plan = read_plan(place, manifest, problems)
        result = read_result(place, manifest, problems) if plan is not None else None
        if plan is not None and result is not None:
            claim = claim_of(plan, manifest, place, problems, suite=suite, files=policies)
        if claim is not None and result is not None:
            try:
                ready = prepared_claim(claim)
            except IrsimError as error:
                problems.add("submission-suite", RESULTS, f"what it claims cannot be run: {error}")
            else:
                check_head(claim, ready, result, problems)
                check_episodes(claim, ready, result, manifest, problems)
                check_log(place, result, problems)
                check_table(place, claim, result, problems)
                runs, records = check_records(place, claim, result, manifest, problems)
                if replay is not None and _rows_fit(problems):
                    again = replay_episodes(
                        place, claim, ready, result, manifest, problems,
                        number=replay, salt=salt, workers=workers, progress=progress,
                    )  # fmt: skip
    name, equal = clean(str(folder), 200), not problems.count
    episodes = 0 if result is None else len(result.episodes)
    unchecked = episodes - len(records | again.rows)
    return SubmissionAudit(
        folder=name,
        equal=equal,
        summary=_summary(name, manifest, claim, len(records), unchecked, again, problems, episodes),
        episodes=episodes,
        sampled=len(records),
        unchecked=unchecked,
        engine="" if manifest is None else clean(manifest.engine, 64),
        replayed=again.done,
        salt=again.salt,
        not_replayed=[clean(text, 400) for text in again.left],
        notes=problems.notes,
        problems=problems.listed,
        problem_count=problems.count,
        runs=runs,
        leaderboard=_leaderboard(result, claim, again) if result is not None and claim is not None and equal else [],
    )


def _rows_fit(problems: Problems) -> bool:
    """Whether each row is of an episode that can be run."""
    return all(problem.code != "submission-rows" for problem in problems.listed)


def _summary(
    name: str,
    manifest: Manifest | None,
    claim: Claim | None,
    sampled: int,
    unchecked: int,
    again: Replay,
    problems: Problems,
    episodes: int,
) -> str:
    """The result in one sentence."""
    ran = "none was run again (--replay does)"
    if again.salt:
        ran = f"{again.done} of {again.drawn} drawn episodes were run again (salt {clean(again.salt, 64)})"
        ran += "" if problems.count else " and are equal"
    if problems.listed:
        first = problems.listed[0]
        tail = f"; {ran}" if again.salt else ""
        return f"{name}: {problems.count} problems; the first: {first.path}: {first.message}{tail}"
    assert manifest is not None
    assert claim is not None  # without problems all are read
    parts = [f"{episodes} episodes", f"{sampled} records begin as the suite does and are equal to their rows"]
    parts += [ran, *([claim.part] if claim.part else [])]
    if unchecked:
        parts.append(f"nothing here checks {unchecked} of {episodes} rows")
    if manifest.engine != engine():
        parts.append(f"it was run by engine {clean(manifest.engine, 64)}, and this is engine {engine()}")
    return f"{name}: {'; '.join(parts)}"


def _leaderboard(result: SuiteResult, claim: Claim, again: Replay) -> list[LeaderboardRow]:
    """A row for each policy and summary; for each scenario where there is no summary."""
    names = {text: name for name, text in result.policies.items()}
    wide = [row for row in result.rows if is_summary(row.scenario)]
    part = f", {claim.part}" if claim.part else ""
    return [
        LeaderboardRow(
            suite=f"{result.suite} {result.suite_version} ({result.suite_hash}){part}", scenes=row.scenario,
            policy=names.get(row.behavior, row.behavior), episodes=row.episodes, success=row.success.rate,
            low=row.success.low, high=row.success.high, collision=row.collision.rate,
            time_to_goal=row.metrics["time_to_goal"].mean,
            replayed=again.by_policy[names.get(row.behavior, row.behavior)],
        )
        for row in wide or result.rows
    ]  # fmt: skip
