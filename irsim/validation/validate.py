"""``irsim.validate``, ``irsim.fix`` and ``irsim.diff``: what is wrong with a scenario, and what an edit changed."""

from __future__ import annotations

from pathlib import Path

from irsim.diagnostics.diagnostic import format_path
from irsim.diagnostics.errors import PlacementError
from irsim.episodes.episode import as_finding, source_of
from irsim.episodes.scene_summary import counts_of, in_words
from irsim.results.diff import ScenarioDiff
from irsim.results.findings import Finding
from irsim.results.validation import DryRun, Fix, ValidationReport
from irsim.scenario.autofix import repair_text
from irsim.scenario.limits import DEFAULT_LIMITS, Limits
from irsim.scenario.read import Reading, read
from irsim.scenario.yaml.document import Document, load_path
from irsim.validation.feasibility import survey

__all__ = ["diff", "fix", "report_of", "validate"]


def validate(
    path: str | Path | None = None,
    *,
    text: str | None = None,
    strict: bool = True,
    base: str | Path | None = None,
    base_text: str | None = None,
    simulate: bool = False,
    seed: int | None = None,
    limits: Limits | None = None,
) -> ValidationReport:
    """Check a scenario without running it.

    Args:
        path: The file.
        text: Or its text.
        strict: What IR-SIM would ignore is an error (default) or a warning.
        base: A file to compare with: ``changes`` then tells what differs from it.
        base_text: Or its text.
        simulate: Also try it, if it is valid: ``dry_run`` then tells what happened in some steps.
        seed: Of what is tried and compared; default: the scenario's own, else 0.
        limits: Tighter or wider limits of the loader and of a run.

    Raises:
        ScenarioNotFoundError: No such file.
        ValueError: Neither or both of ``path`` and ``text``, or both of ``base`` and ``base_text``.
    """
    most = limits or DEFAULT_LIMITS
    reading = read(source_of(path, text, limits), strict=strict, limits=most, survey=survey)
    report = report_of(reading, str(path) if path is not None else "(text)")
    if base is not None or base_text is not None:
        from irsim.validation.diff.compare import compare

        other = read(source_of(base, base_text, limits), strict=strict, limits=most, survey=survey)
        report.changes = compare(other, reading, seed=seed)
        _mark_old(report.findings, other)
    if simulate and reading.scenario is not None:
        report.dry_run = _tried(report, reading, seed, limits)
    return report


def fix(
    path: str | Path | None = None, *, text: str | None = None, strict: bool = True, limits: Limits | None = None
) -> tuple[str, ValidationReport]:
    """Make every repair of a scenario that needs no guessing. Writes nothing.

    Args:
        path: The file.
        text: Or its text.
        strict: What IR-SIM would ignore is an error (default) or a warning.
        limits: Tighter or wider limits of the loader.

    Returns:
        The repaired text, comments and layout as they were, and the report on it: ``fixes`` has what was done. A repair
        that would lose comments is left to you; the finding's ``fix`` says so.

    Raises:
        ScenarioNotFoundError: No such file.
        ValueError: Neither or both of ``path`` and ``text``.
    """
    most = limits or DEFAULT_LIMITS
    source = source_of(path, text, limits)
    document = source if isinstance(source, Document) else load_path(source, most)
    if document.text is None:  # not even read
        return "", report_of(read(document, strict=strict, limits=most), str(path))
    mended = repair_text(document.text, name=document.name, path=document.path, strict=strict, limits=most)
    report = report_of(mended.reading, str(path) if path is not None else "(text)")
    report.fixes = [
        Fix(code=item.finding.code, path=format_path(item.finding.path), line=item.finding.line, change=item.change)
        for item in mended.repairs
    ]
    return mended.text, report


def diff(
    before: str | Path | None = None,
    after: str | Path | None = None,
    *,
    before_text: str | None = None,
    after_text: str | None = None,
    seed: int | None = None,
    limits: Limits | None = None,
) -> ScenarioDiff:
    """What differs between two scenarios: by key in the files, by object in the worlds they become.

    Args:
        before: A file.
        after: Another.
        before_text: Or the text of the first.
        after_text: Or the text of the second.
        seed: Both worlds are built with it; default: the scenario's own, else 0.
        limits: Tighter or wider limits of the loader.

    Raises:
        ScenarioNotFoundError: No such file.
        ValueError: Neither or both of a path and a text.
    """
    from irsim.validation.diff.compare import compare

    most = limits or DEFAULT_LIMITS
    pair = ((before, before_text), (after, after_text))
    a, b = (read(source_of(path, text, limits), strict=True, limits=most) for path, text in pair)
    return compare(a, b, seed=seed)


def report_of(reading: Reading, file: str) -> ValidationReport:
    """What reading a scenario gave, as a report."""
    findings = [as_finding(d) for d in reading.diagnostics]
    count = {s: sum(f.severity == s for f in findings) for s in ("error", "warning", "hint")}
    scenario, counts = reading.scenario, dict[str, int]()
    if scenario is not None:
        counts = counts_of(scenario)
        summary = f"valid: {in_words(counts)}"
        if count["warning"]:
            summary += f"; {count['warning']} warning{'s' * (count['warning'] != 1)}"
    else:
        summary = f"{count['error']} error{'s' * (count['error'] != 1)}, {count['warning']} warnings"
    return ValidationReport(
        file=file,
        valid=count["error"] == 0,
        summary=summary,
        errors=count["error"],
        warnings=count["warning"],
        hints=count["hint"],
        findings=findings,
        counts=counts,
    )


def _mark_old(findings: list[Finding], base: Reading) -> None:
    """Note which findings the scenario that was compared with has too: same code, and same place or words."""
    known = {(item.code, told) for item in base.diagnostics for told in (format_path(item.path), item.message)}
    for finding in findings:
        finding.in_base = bool({(finding.code, finding.path), (finding.code, finding.message)} & known)


def _tried(report: ValidationReport, reading: Reading, seed: int | None, limits: Limits | None) -> DryRun | None:
    """The dry run; a seed that finds no room is a finding more."""
    from irsim.validation.dry_run import dry_run

    assert reading.scenario is not None
    try:
        return dry_run(reading.scenario, seed=seed, limits=limits)
    except PlacementError as error:
        crowded = [as_finding(item) for item in error.diagnostics]
        report.findings = [*crowded, *report.findings]
        report.errors += len(crowded)
        report.valid = False
        report.summary = f"{report.errors} error{'s' * (report.errors != 1)}, {report.warnings} warnings"
        return None
