"""The report of ``irsim validate`` on a suite file."""

from __future__ import annotations

from dataclasses import replace

from irsim.benchmarks.suite_file import SuiteError, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.results.findings import Finding
from irsim.results.validation import ValidationReport

__all__ = ["suite_report"]


def suite_report(word: str) -> ValidationReport:
    """Check a suite and every scenario that it expands to, without running it.

    Args:
        word: Name of a bundled suite, or path of a suite file.
    """
    try:
        suite, _ = load_suite(word)
        plan = suite_plan(word)
    except SuiteError as error:
        whole = Diagnostic("invalid-value", "error", (), error.message, fix=error.fix)
        findings = [Finding.of(_of_this_file(item, word)) for item in error.diagnostics or [whole]]
        summary = f"{len(findings)} error{'s' * (len(findings) != 1)}, 0 warnings"
        return ValidationReport(
            file=word, valid=False, summary=summary, errors=len(findings), warnings=0, hints=0, findings=findings
        )
    size = f"{len(plan.scenarios)} scenarios x {len(plan.policies)} policies x {len(plan.seeds)} seeds"
    return ValidationReport(
        file=word, valid=True, summary=f"valid: suite {suite.suite}, {size}", errors=0, warnings=0, hints=0, findings=[]
    )


def _of_this_file(item: Diagnostic, word: str) -> Diagnostic:
    """A problem with its place in the suite file; one of another file names that file in its message."""
    if item.file in (None, word):
        return item
    line = "" if item.line is None else f", line {item.line}"
    return replace(item, message=f"{item.file}{line}: {item.message}", line=None, column=None, length=1)
