"""``irsim.validate``, ``irsim.fix`` and ``irsim.diff``: what is wrong with a scenario, and what an edit changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

from irsim.common.keywords import answers_misspelt
from irsim.common.text import plural
from irsim.diagnostics.diagnostic import Diagnostic, format_path
from irsim.diagnostics.errors import PlacementError
from irsim.episodes.rounds import when_it_ends
from irsim.episodes.scene_summary import counts_of, in_words
from irsim.episodes.suitability import check_policy_name
from irsim.results.findings import Finding
from irsim.results.validation import Fix, ScenarioDiff, ValidationReport
from irsim.scenario.autofix import repair_text
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.open import document_of
from irsim.scenario.read import Reading, read
from irsim.scenario.resolve.resolved import ResolvedScenario
from irsim.validation.diff.compare import compare
from irsim.validation.diff.motion import motion_changes
from irsim.validation.dry_run import try_out
from irsim.validation.feasibility.check import feasibility_findings

__all__ = ["diff", "fix", "report", "report_of", "validate", "warn_of_collisions"]


@answers_misspelt
def validate(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    strict: bool = True,
    base: str | Path | None = None,
    base_text: str | None = None,
    simulate: bool = False,
    seed: int | None = None,
    policy: str | None = None,
    limits: Limits | None = None,
) -> ValidationReport:
    """Check a scenario without running it.

    Args:
        path: Path of the scenario file.
        text: Text of the scenario, instead of ``path``.
        strict: Input that IR-SIM would ignore is an error (default) or a warning.
        base: Path of a file to compare with: ``changes`` then lists the differences from it.
        base_text: Text to compare with, instead of ``base``.
        simulate: Also simulate the first steps of a valid scenario: ``dry_run`` then summarises them.
        seed: Seed of the dry run and of the comparison; default: the scenario's own, else 0.
        policy: Name of a policy that is to drive the robots: a warning says where the scene is not one that it is for.
        limits: Tighter or wider limits of the loader and of a run.

    Raises:
        ScenarioNotFoundError: There is no such file.
        UnknownPolicyError: No policy has that name.
        ValueError: Neither or both of ``path`` and ``text`` are given, or both of ``base`` and ``base_text``.
    """
    if policy is not None:
        check_policy_name(policy)
    most = limits or DEFAULT_LIMITS
    checks = partial(feasibility_findings, policy=policy)
    reading = read(document_of(path, text, limits), strict=strict, limits=most, feasibility=checks)
    report = report_of(reading, str(path) if path is not None else "(text)")
    other: Reading | None = None
    if base is not None or base_text is not None:
        other = read(document_of(base, base_text, limits), strict=strict, limits=most, feasibility=feasibility_findings)
        report.changes = compare(other, reading, seed=seed)
        _mark_old(report.findings, other)
    if simulate and reading.scenario is not None:
        _try_out(report, reading, other, seed, limits)
        if report.dry_run is not None:
            hit = {name for event in report.dry_run.collisions for name in (event.object, event.partner)}
            if more := warn_of_collisions(report.findings, reading.scenario, {str(name) for name in hit}):
                report.hints, report.warnings = report.hints - more, report.warnings + more
                report.summary = f"{report.summary.partition(';')[0]}; {plural(report.warnings, 'warning')}"
    elif reading.scenario is not None and (ends := when_it_ends(reading.scenario.robots())):
        report.summary += f"; {ends}"
    return report


@answers_misspelt
def fix(
    path: str | Path | None = None, *, text: str | None = None, strict: bool = True, limits: Limits | None = None
) -> tuple[str, ValidationReport]:
    """Make every repair of a scenario that needs no guessing, without writing a file.

    Args:
        path: Path of the scenario file.
        text: Text of the scenario, instead of ``path``.
        strict: Input that IR-SIM would ignore is an error (default) or a warning.
        limits: Tighter or wider limits of the loader.

    Returns:
        The repaired text, with its comments and layout, and the report on it: ``fixes`` lists the repairs. A repair
        that would lose comments is not made; the ``fix`` of its finding says what to change.

    Raises:
        ScenarioNotFoundError: There is no such file.
        ValueError: Neither or both of ``path`` and ``text`` are given.
    """
    most = limits or DEFAULT_LIMITS
    document = document_of(path, text, limits)
    if document.text is None:  # the file could not be read
        return "", report_of(read(document, strict=strict, limits=most), str(path))
    mended = repair_text(document.text, name=document.name, path=document.path, strict=strict, limits=most)
    report = report_of(mended.reading, str(path) if path is not None else "(text)")
    report.fixes = [
        Fix(code=item.finding.code, path=format_path(item.finding.path), line=item.finding.line, change=item.change)
        for item in mended.repairs
    ]
    return mended.text, report


@answers_misspelt
def diff(
    before: str | Path | None = None,
    after: str | Path | None = None,
    *,
    before_text: str | None = None,
    after_text: str | None = None,
    seed: int | None = None,
    run: bool = False,
    limits: Limits | None = None,
) -> ScenarioDiff:
    """Compare two scenarios: their files by key, and the worlds built from them by object.

    Args:
        before: Path of the first file.
        after: Path of the second file.
        before_text: Text of the first scenario, instead of ``before``.
        after_text: Text of the second scenario, instead of ``after``.
        seed: Seed with which both worlds are built; default: the scenario's own, else 0.
        run: Also simulate the first steps of both, and compare what happens: ``motion``.
        limits: Tighter or wider limits of the loader.

    Raises:
        ScenarioNotFoundError: There is no such file.
        ValueError: Neither or both of a path and a text are given.
    """
    most = limits or DEFAULT_LIMITS
    pair = ((before, before_text), (after, after_text))
    if run:
        changes = validate(
            after, text=after_text, base=before, base_text=before_text, simulate=True, seed=seed, limits=limits
        ).changes
        assert changes is not None
        return changes
    a, b = (read(document_of(path, text, limits), strict=True, limits=most) for path, text in pair)
    return compare(a, b, seed=seed)


def report_of(reading: Reading, file: str) -> ValidationReport:
    """The report on a scenario that has been read."""
    if reading.scenario is None:
        return report(file, reading.diagnostics)
    counts = counts_of(reading.scenario)
    answer = report(file, reading.diagnostics, in_words(counts))
    answer.counts = counts
    return answer


def report(file: str, diagnostics: Sequence[Diagnostic], valid: str | None = None) -> ValidationReport:
    """The report on a file of any kind.

    Args:
        file: The file.
        diagnostics: Its problems.
        valid: Content of a file without errors, in words.
    """
    count = Counter(item.severity for item in diagnostics)
    summary = _counted(count["error"], count["warning"])
    if valid is not None:
        warnings = f"; {plural(count['warning'], 'warning')}" if count["warning"] else ""
        summary = f"valid: {valid}{warnings}"
    return ValidationReport(
        file=file,
        valid=valid is not None,
        summary=summary,
        errors=count["error"],
        warnings=count["warning"],
        hints=count["hint"],
        findings=[Finding.of(item) for item in diagnostics],
    )


def _counted(errors: int, warnings: int) -> str:
    return f"{plural(errors, 'error')}, {plural(warnings, 'warning')}"


def _mark_old(findings: list[Finding], base: Reading) -> None:
    """Mark the findings that the base scenario also has, with the same code and the same path or message."""
    known = {(item.code, text) for item in base.diagnostics for text in (format_path(item.path), item.message)}
    for finding in findings:
        finding.in_base = bool({(finding.code, finding.path), (finding.code, finding.message)} & known)


def warn_of_collisions(findings: Sequence[Finding], scenario: ResolvedScenario, hit: Collection[str]) -> int:
    """Make hints that a robot dashes into an obstacle warnings where it has collided; return their number.

    Args:
        findings: Findings about the scenario.
        scenario: The scenario.
        hit: Names of objects that have collided.
    """
    entries, count = {format_path(record.path) for record in scenario.robots() if record.name in hit}, 0
    for finding in findings:
        if finding.code != "dash-into-obstacle" or finding.severity != "hint":
            continue
        if any(finding.path.startswith(f"{entry}.") or finding.path == entry for entry in entries):
            finding.severity, count = "warning", count + 1
            finding.message += "; it collided when tried"
    return count


def _try_out(
    report: ValidationReport, reading: Reading, base: Reading | None, seed: int | None, limits: Limits | None
) -> None:
    """Add the dry run and how its motion differs from the base's with the same seed.

    If a random object has no free place with the seed, that is added to the findings instead.
    """
    assert reading.scenario is not None
    try:
        trial = try_out(reading.scenario, seed=seed, limits=limits)
    except PlacementError as error:
        crowded = [Finding.of(item) for item in error.diagnostics]
        report.findings = [*crowded, *report.findings]
        report.errors += len(crowded)
        report.valid = False
        report.summary = _counted(report.errors, report.warnings)
        return
    report.dry_run = trial.result
    if base is None or base.scenario is None or report.changes is None:
        return
    if report.changes.same:
        report.changes.motion = []
        return
    with suppress(PlacementError):  # the base has no room with this seed
        before = try_out(base.scenario, seed=trial.result.seed, limits=limits)
        report.changes.motion = motion_changes(before, trial)
