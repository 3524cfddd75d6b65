"""Printing of diagnostics, import of user modules, and the limits for reading a scenario."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from irsim.api import import_modules
from irsim.bundled.templates.fill import parse_path
from irsim.cli.output import has_colors
from irsim.common.text import plural
from irsim.diagnostics.diagnostic import Diagnostic
from irsim.diagnostics.errors import CodedError
from irsim.diagnostics.report import format_diagnostics
from irsim.results.findings import Finding
from irsim.results.validation import ValidationReport
from irsim.scenario.limits import Limits
from irsim.scenario.locate import locate
from irsim.scenario.yaml.document import text_of

__all__ = [
    "UserImportError",
    "import_user_modules",
    "limits_for",
    "not_found",
    "print_diagnostics",
    "print_findings",
    "print_warnings",
    "tolerated_note",
]

_MEND_LATER = ("unknown-behavior", "behavior-for-other-drive")
"""Codes of what a run tolerates only if a program has mended it before the first step (difference D5)."""


class UserImportError(CodedError, ImportError):
    """A module named by ``--import`` cannot be imported."""


def print_diagnostics(diagnostics: Sequence[Diagnostic], text: str | None, *, stderr: bool = False) -> None:
    """Print diagnostics with the lines of the scenario that they refer to.

    Args:
        diagnostics: The diagnostics.
        text: Text of the scenario.
        stderr: Print to standard error instead of standard output.
    """
    if not diagnostics:
        return
    stream = sys.stderr if stderr else sys.stdout
    print(format_diagnostics(diagnostics, text, color=has_colors(stream)), file=stream)


def print_findings(findings: Sequence[Finding], file: str, text: str | None = None, *, stderr: bool = False) -> None:
    """Print the findings of a result.

    Args:
        findings: Findings of a result.
        file: File of the scenario.
        text: Text of the scenario; None reads the file again.
        stderr: Print to standard error instead of standard output.
    """
    if not findings:
        return
    diagnostics = [
        Diagnostic(
            code=finding.code,
            severity=finding.severity,
            path=parse_path(finding.path),
            message=finding.message,
            line=finding.line,
            column=finding.column,
            length=finding.length,
            allowed=finding.allowed,
            fix=finding.fix,
            file=file,
        )
        for finding in findings
    ]
    print_diagnostics(diagnostics, _text_of(file) if text is None else text, stderr=stderr)


def print_warnings(findings: Sequence[Finding], file: str) -> None:
    """Print the warnings about a scenario that was used, and how many hints ``irsim validate`` explains.

    Args:
        findings: Findings of a result.
        file: File of the scenario.
    """
    print_findings([one for one in findings if one.severity != "hint"], file, stderr=True)
    if note := tolerated_note(findings):
        print(f"{note}: run and render go on, validate and --strict refuse it", file=sys.stderr)
    if hints := dict.fromkeys(one.code for one in findings if one.severity == "hint"):
        what = f"{plural(len(hints), 'hint')} ({', '.join(hints)}): irsim validate {shlex.quote(file)} explains"
        print(what, file=sys.stderr)


def tolerated_note(findings: Sequence[Finding]) -> str:
    """The start of the sentence on what IR-SIM 2.12 tolerates, with the difference to look up; empty without any."""
    count = sum(one.tolerated and one.code not in _MEND_LATER for one in findings)
    return f"{plural(count, 'problem')} that IR-SIM 2.12 tolerates (irsim describe D4)" if count else ""


def import_user_modules(names: Sequence[str] | None) -> None:
    """Import user modules, which register behaviors and other components.

    Raises:
        UserImportError: A module raised an error.
    """
    for name in names or ():
        try:
            import_modules([name])
        except Exception as error:
            raise UserImportError("import-failed", f"--import {name}: {type(error).__name__}: {error}") from error


def limits_for(max_objects: int | None) -> Limits | None:
    """Return the limits for reading a scenario with another number of objects; None stands for the default limits."""
    return None if max_objects is None else Limits(objects=max_objects, robots=max_objects)


def not_found(file: str, message: str) -> ValidationReport:
    """Return the report on a file that does not exist."""
    finding = Finding(
        code="file-not-found", severity="error", path="(document)", line=None, column=None, message=message
    )
    return ValidationReport(
        file=file, valid=False, summary="1 error, 0 warnings", errors=1, warnings=0, hints=0, findings=[finding]
    )


def _text_of(file: str) -> str | None:
    if not Path(file).is_file():
        from irsim.benchmarks.suite_plan import suite_scene  # which few commands need

        if (scene := suite_scene(file)) is not None:
            return scene.text
    text = text_of(locate(file))
    return text if isinstance(text, str) else None
