"""``irsim validate``: report all problems of scenario files at once."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from irsim import api
from irsim.benchmarks.suite import SUITES, is_suite
from irsim.cli.findings import import_user_modules, limits_for, not_found, print_findings, tolerated_note
from irsim.cli.guard import INVALID
from irsim.cli.options import Imports, MaxObjects, seed_option
from irsim.cli.output import console, print_json, progress
from irsim.common.files import write_atomically
from irsim.common.text import clean, seconds
from irsim.diagnostics.errors import InputError, ScenarioNotFoundError
from irsim.learning.tasks.files import TASKS
from irsim.scenario.locate import locate
from irsim.validation.file_reports import suite_report, task_report
from irsim.validation.scene_table import scene_table
from irsim.validation.scene_text import scene_lines

if TYPE_CHECKING:
    from rich.console import Console

    from irsim.results.validation import DryRun, ValidationReport
    from irsim.scenario.limits import Limits

__all__ = ["validate"]


def validate(
    files: Annotated[
        list[str],
        typer.Argument(metavar="FILE...", help="Scenario files, suites or tasks; - is a scenario from standard input."),
    ],
    json_output: Annotated[
        bool, typer.Option("--json", help="Print only one JSON object per file, one per line.")
    ] = False,
    lenient: Annotated[
        bool, typer.Option("--lenient", help="Report problems that `irsim run` tolerates as warnings.")
    ] = False,
    fix: Annotated[
        bool,
        typer.Option(
            "--fix",
            help="Repair the file where the repair is unambiguous; comments stay. With -, print the repaired text to "
            "standard output and the findings to standard error.",
        ),
    ] = False,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Also simulate the scenario for about a second and report what happens.")
    ] = False,
    table: Annotated[
        bool,
        typer.Option(
            "--table", help="Also print what a valid scenario becomes: drives, footprints, places, what is random."
        ),
    ] = False,
    seed: Annotated[
        int | None,
        seed_option(
            "Random seed of --simulate and --table, 0 or more. Default: the seed of the scenario, otherwise 0."
        ),
    ] = None,
    policy: Annotated[
        str | None,
        typer.Option(
            "--for-policy",
            metavar="NAME",
            help="Also warn where a scene is not one that this policy is for; irsim policies lists them.",
            show_default=False,
        ),
    ] = None,
    imports: Imports = None,
    max_objects: MaxObjects = None,
) -> None:
    """Check scenario files, suites and tasks without running them; the exit code is 2 if any file is invalid."""
    import_user_modules(imports)
    filtering = fix and "-" in files
    if table and json_output:
        raise InputError("--table prints text, so it cannot be combined with --json", "leave out one of them")
    if filtering and (json_output or len(files) > 1):
        raise InputError(
            "--fix with - prints the repaired text, so it cannot be combined with --json or other files",
            "leave out --json and other files, or give the name of a file instead of -",
        )
    kinds = {file: _kind(file) for file in files}
    _check_options(kinds, fix=fix, simulate=simulate, table=table)
    valid = True
    for file in files:
        text = sys.stdin.read() if file == "-" else None
        with progress(f"checking {file}"):
            try:
                if kinds[file] == "a scenario":
                    report, text = _check_file(
                        file, text, fix, simulate, seed, not lenient, limits_for(max_objects), policy
                    )
                else:
                    report = suite_report(file) if kinds[file] == "a suite" else task_report(file)
                    if file in SUITES.names():  # a name, not a path
                        text = SUITES.bundled(file).read_text(encoding="utf-8")
            except ScenarioNotFoundError as error:  # continue with the other files
                report, text = not_found(file, str(error)), ""
        valid &= report.valid
        if json_output:
            print_json(report, line=True)
        else:
            _show(report, file, text, stderr=filtering)
        if table and report.valid and kinds[file] == "a scenario":
            _show_table(file, text, seed, limits_for(max_objects), stderr=filtering)
        if filtering:
            sys.stdout.write(text or "")
    if not valid:
        raise typer.Exit(INVALID)


def _kind(file: str) -> str:
    """The kind of a file: ``a suite``, ``a task`` or ``a scenario``."""
    if file == "-":
        return "a scenario"
    return "a suite" if is_suite(file) else "a task" if TASKS.is_file(file) else "a scenario"


def _check_options(kinds: dict[str, str], **given: bool) -> None:
    """Refuse options of scenarios where no file is one; otherwise they hold for the scenarios among the files."""
    used = next((f"--{name}" for name, on in given.items() if on), None)
    if used is not None and "a scenario" not in kinds.values():
        file, kind = next(iter(kinds.items()))
        raise InputError(f"{used} belongs to scenario files, and {file} is {kind}", f"leave out {used}")


def _check_file(
    file: str,
    text: str | None,
    fix: bool,
    simulate: bool,
    seed: int | None,
    strict: bool,
    limits: Limits | None,
    policy: str | None = None,
) -> tuple[ValidationReport, str | None]:
    """Return the report on a scenario, a file or standard input, and its text; with ``fix``, on the repaired one."""
    path = None if file == "-" else file
    if text is not None and SUITES.is_text(text):
        raise InputError("- stands for a scenario, and this is a suite", "give the name of its file instead of -")
    fixes, fix_texts = [], {}
    if fix:
        mended, report = api.fix(path, text=text, strict=strict, limits=limits)
        fixes = report.fixes
        # these texts also give the reason why a problem was not repaired
        fix_texts = {(item.code, item.path): item.fix for item in report.findings}
        if fixes and path is None:
            text = mended
        elif fixes:
            write_atomically(Path(locate(file)), mended)
    report = api.validate(path, text=text, strict=strict, simulate=simulate, seed=seed, policy=policy, limits=limits)
    report.fixes = fixes
    for item in report.findings:
        item.fix = fix_texts.get((item.code, item.path), item.fix)
    return report, text


def _show(report: ValidationReport, file: str, text: str | None, *, stderr: bool) -> None:
    out = console(stderr=stderr)
    for item in report.fixes:
        line = "" if item.line is None else f"line {item.line}: "
        out.print(
            Text.assemble(("fixed", "bold green"), f" {item.code}  {line}{clean(item.change, 300)}"), soft_wrap=True
        )
    print_findings(report.findings, file, text=text, stderr=stderr)
    if note := tolerated_note(report.findings):
        out.print(f"{note}: irsim run warns and goes on, unless --strict is given")
    if report.dry_run is not None:
        show_dry_run(report.dry_run, out)
    if report.valid:
        out.print(Text.assemble((report.file, "bold"), ": ", (report.summary, "bold green")))


def _show_table(file: str, text: str | None, seed: int | None, limits: Limits | None, *, stderr: bool) -> None:
    scenario, _ = api.read_scenario(None if file == "-" else file, text=text, strict=False, limits=limits)
    chosen = seed if seed is not None else scenario.world.seed or 0
    for line in scene_lines(scene_table(scenario, chosen).model_dump(), {}, chosen):
        console(stderr=stderr).print(Text(line), soft_wrap=True)


def show_dry_run(dry_run: DryRun, out: Console) -> None:
    """Print the result of a dry run.

    Args:
        dry_run: Dry run of a report.
        out: Console to print to.
    """
    seed = f" (seed {dry_run.seed})" if dry_run.random else ""
    lines = [
        f"'{e.object}' with '{e.partner}' at {seconds(e.time)}, ({e.x:.2f}, {e.y:.2f})" for e in dry_run.collisions[1:]
    ]
    lines += [
        f"'{s.name}' {s.doing} since {seconds(s.since)} at ({s.x:.2f}, {s.y:.2f}): {s.why}" for s in dry_run.stuck[1:]
    ]
    lines += [f"'{gone.name}' left the world at {seconds(gone.time)}" for gone in dry_run.left[1:]]
    out.print(Text.assemble(("tried", "bold"), f"{seed}: {clean(dry_run.summary, 600)}"), soft_wrap=True)
    for line in lines:
        out.print(f"  {clean(line, 200)}", soft_wrap=True)
