"""``irsim validate``: everything that is wrong with scenario files, at once."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from irsim.cli.guard import INVALID
from irsim.cli.options import Imports, MaxObjects
from irsim.errors import ScenarioNotFoundError

if TYPE_CHECKING:
    from irsim.results import ValidationReport

__all__ = ["validate"]


def validate(
    files: Annotated[list[str], typer.Argument(metavar="FILE...", help="Scenario files; - is standard input.")],
    json_output: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per file, one per line, and nothing else.")
    ] = False,
    lenient: Annotated[
        bool, typer.Option("--lenient", help="Only warn where IR-SIM would carry on, as irsim run does.")
    ] = False,
    imports: Imports = None,
    max_objects: MaxObjects = None,
) -> None:
    """Check scenario files without running them. Exits with 2 if any is invalid."""
    from irsim.cli.findings import import_user_modules, limits_for, not_found
    from irsim.cli.output import print_json, progress

    import_user_modules(imports)
    valid = True
    for file in files:
        text = sys.stdin.read() if file == "-" else None
        with progress(f"checking {file}"):
            from irsim import api

            try:
                report = api.validate(
                    None if file == "-" else file, text=text, strict=not lenient, limits=limits_for(max_objects)
                )
            except ScenarioNotFoundError as error:  # the other files are checked all the same
                report, text = not_found(file, str(error)), ""
        valid &= report.valid
        if json_output:
            print_json(report, indent=None)
        else:
            _show(report, file, text)
    if not valid:
        raise typer.Exit(INVALID)


def _show(report: ValidationReport, file: str, text: str | None) -> None:
    from rich.text import Text

    from irsim.cli.findings import print_findings
    from irsim.cli.output import console

    print_findings(report.findings, file, text=text)
    if report.valid:
        console().print(Text.assemble((report.file, "bold"), ": ", (report.summary, "bold green")))
