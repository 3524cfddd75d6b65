"""Printing diagnostics, and the two things every verb does before it reads a scenario."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.cli.output import has_colors
from irsim.diagnostics.errors import CodedError

if TYPE_CHECKING:
    from irsim.diagnostics.diagnostic import Diagnostic
    from irsim.results.findings import Finding
    from irsim.results.validation import ValidationReport
    from irsim.scenario.limits import Limits

__all__ = ["UserImportError", "import_user_modules", "limits_for", "not_found", "print_diagnostics", "print_findings"]


class UserImportError(CodedError, ImportError):
    """A module named by ``--import`` cannot be imported."""


def print_diagnostics(diagnostics: Sequence[Diagnostic], text: str | None, *, stderr: bool = False) -> None:
    """Print diagnostics with the lines they are about.

    Args:
        diagnostics: What was found.
        text: The scenario's text.
        stderr: To standard error instead of standard output.
    """
    if not diagnostics:
        return
    from irsim.diagnostics.report import format_diagnostics

    stream = sys.stderr if stderr else sys.stdout
    print(format_diagnostics(diagnostics, text, color=has_colors(stream)), file=stream)


def print_findings(findings: Sequence[Finding], file: str, text: str | None = None, *, stderr: bool = False) -> None:
    """Print the findings of a result.

    Args:
        findings: From a result.
        file: The scenario they are about.
        text: Its text; None reads the file again.
        stderr: To standard error instead of standard output.
    """
    if not findings:
        return
    from irsim.bundled.templates.fill import parse_path
    from irsim.diagnostics.diagnostic import Diagnostic

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


def import_user_modules(names: Sequence[str] | None) -> None:
    """Import user modules, for what they register.

    Raises:
        UserImportError: Whatever went wrong in one of them.
    """
    if not names:
        return
    from irsim.api import import_modules

    for name in names:
        try:
            import_modules([name])
        except Exception as error:
            raise UserImportError("import-failed", f"--import {name}: {type(error).__name__}: {error}") from error


def limits_for(max_objects: int | None) -> Limits | None:
    """Limits of the loader with another number of objects; None for the defaults."""
    if max_objects is None:
        return None
    from irsim.scenario.limits import Limits

    return Limits(objects=max_objects, robots=max_objects)


def not_found(file: str, message: str) -> ValidationReport:
    """The report on a file that does not exist."""
    from irsim.results.findings import Finding
    from irsim.results.validation import ValidationReport

    finding = Finding(
        code="file-not-found", severity="error", path="(document)", line=None, column=None, message=message
    )
    return ValidationReport(
        file=file, valid=False, summary="1 error, 0 warnings", errors=1, warnings=0, hints=0, findings=[finding]
    )


def _text_of(file: str) -> str | None:
    from irsim.scenario.locate import locate
    from irsim.scenario.yaml.document import load_path

    return load_path(locate(file)).text
