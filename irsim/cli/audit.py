"""``irsim audit``: recompute recorded runs from their files alone, and compare."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from rich.table import Table

from irsim.api.audit_submission import DEFAULT_REPLAYS, audit_all
from irsim.cli.guard import FAILED
from irsim.cli.options import Json
from irsim.cli.output import console, print_json, progress
from irsim.common.text import clean
from irsim.diagnostics.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from irsim.results.audit import AuditFinding, RunAudit, SubmissionAudit

__all__ = ["audit"]

MAX_ROWS = 10
"""Differences, contacts within the tolerance and robots of each run that are shown."""


_NAME_WIDTH = 16
"""Width of the names of policies in a table that also has room for the rates in 80 columns [characters]."""
_RATES = {"episodes": 8, "success": 7, "95 %": 16, "collision": 9, "time s": 6}
"""Heading of a column of the leaderboard -> its width [characters]."""


def audit(
    runs: Annotated[
        list[str],
        typer.Argument(
            metavar="RUN...",
            help="Id, folder or a file of a recorded run, or 'last', or the folder of a submission. Each is audited.",
            show_default=False,
        ),
    ],
    replay: Annotated[
        str | None,
        typer.Option(
            metavar="N|all",
            help="Run N episodes of a submission again, drawn from all its rows, and compare rows and traces. "
            f"{DEFAULT_REPLAYS} find changes in 5 % of the rows in 19 of 20 audits.",
            show_default=False,
        ),
    ] = None,
    salt: Annotated[
        str | None,
        typer.Option(metavar="TEXT", help="Draw the episodes of an earlier audit again.", show_default=False),
    ] = None,
    policy: Annotated[
        list[str] | None,
        typer.Option(
            "--policy-file",
            metavar="NAME=FILE",
            help="File of a policy that the submission does not hold. Repeatable.",
            show_default=False,
        ),
    ] = None,
    suite: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="File of the suite, if it is not a bundled one.", show_default=False),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Maximum number of processes. Default: all cores.", show_default=False)
    ] = None,
    json_output: Json = False,
) -> None:
    """Check recorded runs from their files alone: contacts, limits, arrivals, outcome and metrics; no engine runs.

    Contacts are recomputed within steps, too, along the twist of each object. Scenes of a submission are drawn again
    from the installed suite. The exit code is 1 if anything differs, or if a run cannot be read.
    """
    with progress("running again") as report:
        result = audit_all(
            runs, replay=_number(replay), salt=salt, policies=_files(policy or []), suite=suite, workers=workers,
            progress=report,
        )  # fmt: skip
    if json_output:
        print_json(result)
    else:
        out = console()
        for run in result.runs:
            _show(run, out)
        for submission in result.submissions:
            _show_submission(submission, out)
        if len(result.runs) + len(result.submissions) > 1:
            out.print(result.summary, soft_wrap=True)
    if not result.equal:
        raise typer.Exit(FAILED)


def _number(text: str | None) -> int | Literal["all"] | None:
    """How many episodes are run again."""
    if text is None or text == "all":
        return None if text is None else "all"
    if not text.isdecimal() or int(text) < 1:
        raise InputError(f"--replay takes a number from 1 on or all, got {clean(text, 40)}", "such as --replay 60")
    return int(text)


def _files(given: Sequence[str]) -> dict[str, str]:
    """Name of a policy -> its file."""
    pairs = [text.partition("=") for text in given]
    odd = next((text for text, (name, sign, file) in zip(given, pairs, strict=True) if not (name and file)), None)
    if odd is not None:
        raise InputError(
            f"--policy-file takes NAME=FILE, got {clean(odd, 100)}", "such as --policy-file mine.npz=mine.npz"
        )
    return {name: file for name, _, file in pairs}


def _table(first: str, min_width: int | None = None) -> Table:
    """A table of whose columns only the first, with names, may become narrower than its content."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column(first, overflow="fold", min_width=min_width)
    return table


def _show(run: RunAudit, out: Console) -> None:
    out.print(clean(run.summary, 600), style="green" if run.equal else "bold red")
    for check in run.checks:
        note = f" ({clean(check.note, 300)})" if check.note else ""
        count = f"{check.compared} values" if check.compared else ""
        odd = f", {check.differences} differ" if check.differences else ""
        out.print(f"  {check.name}: {check.status.replace('_', ' ')} {count}{odd}{note}".rstrip())
    for problem in run.problems:
        fix = f"; fix: {clean(problem.fix, 300)}" if problem.fix else ""
        out.print(f"  {problem.code}: {clean(problem.path, 200)}{fix}")
    for finding in run.findings[:MAX_ROWS]:
        print_finding(finding, out)
    if run.finding_count > MAX_ROWS:
        out.print(f"  ... and {run.finding_count - MAX_ROWS} more differences")
    for near in run.within_tolerance[:MAX_ROWS]:
        pair = f"{clean(near.object, 40)} and {clean(near.partner, 40)} in step {near.step}"
        out.print(f"  within tolerance: {pair}, {near.gap:.2g} m apart, {near.note}")
    if run.within_tolerance_count > MAX_ROWS:
        out.print(f"  ... and {run.within_tolerance_count - MAX_ROWS} more within the tolerance")
    if not run.robots:
        return
    table = _table("robot")
    for heading in ("outcome", "arrived\ns", "path\nm", "mean\nm/s", "clearance\nm", "contacts", "within\nsteps"):
        table.add_column(heading, no_wrap=True)
    for robot in run.robots[:MAX_ROWS]:
        numbers = (robot.time_to_goal, robot.path_length, robot.mean_speed, robot.min_clearance)
        cells = ("-" if number is None else f"{number:.4g}" for number in numbers)
        counts = (str(robot.contacts), str(robot.contacts_between_steps))
        table.add_row(clean(robot.name, 40), robot.outcome, *cells, *counts)
    out.print(table)
    if len(run.robots) > MAX_ROWS:
        out.print(f"... and {len(run.robots) - MAX_ROWS} more robots")
    out.print(
        f"contacts nearer than {run.tolerance:g} m to touching are not decided; an overlap of more than "
        f"{max(run.unseen_depth, run.tolerance):.1g} m cannot have been missed between the poses that were looked at",
        style="dim",
    )


def _show_submission(submission: SubmissionAudit, out: Console) -> None:
    out.print(clean(submission.summary, 600), style="green" if submission.equal else "bold red")
    for problem in submission.problems[:MAX_ROWS]:
        given = "" if problem.given is None else f": given {clean(str(problem.given), 100)}"
        known = "" if problem.allowed is None else f", recomputed {clean(str(problem.allowed), 100)}"
        line = f"  {problem.code}: {clean(problem.path, 200)}: {clean(problem.message, 400)}{given}{known}"
        out.print(line)
    if submission.problem_count > MAX_ROWS:
        out.print(f"  ... and {submission.problem_count - MAX_ROWS} more problems")
    if submission.problems:
        out.print(f"  fix: {clean(submission.problems[0].fix or '', 300)}")
    for text in (*submission.not_replayed, *submission.notes):
        out.print(f"  note: {clean(text, 400)}", style="yellow")
    if submission.engine:
        repeat = f"; --replay {submission.replayed} --salt {submission.salt} repeats it" if submission.salt else ""
        out.print(f"  engine {clean(submission.engine, 64)}{repeat}", soft_wrap=True, style="dim")
    if not submission.leaderboard:
        return
    _show_leaderboard(submission, out)
    if submission.unchecked:
        rows = f"{submission.unchecked} of {submission.episodes} rows behind these rates"
        text = f"{rows} are the submitter's word: no record has them, and this audit did not run them again"
        out.print(f"{text}; --replay all runs every row", style="yellow")


def _show_leaderboard(submission: SubmissionAudit, out: Console) -> None:
    """Print the rates of each policy, below the name of its scenes."""
    out.print(clean(submission.leaderboard[0].suite, 200), style="italic")
    again = ("run\nagain",) if submission.salt else ()
    width = min(_NAME_WIDTH, max(len(clean(row.policy, 40)) for row in submission.leaderboard))
    for number, (scenes, rows) in enumerate(groupby(submission.leaderboard, lambda row: row.scenes)):
        table = _table("policy", min_width=width)
        table.show_header = number == 0
        for heading, least in _RATES.items():
            table.add_column(heading, no_wrap=True, min_width=least)
        for heading in again:
            table.add_column(heading, no_wrap=True)
        for row in rows:
            ends = "-" if row.low is None or row.high is None else f"{row.low:.1%} to {row.high:.1%}"
            time = "-" if row.time_to_goal is None else f"{row.time_to_goal:.2f}"
            rates = (str(row.episodes), f"{row.success:.1%}", ends, f"{row.collision:.1%}", time)
            table.add_row(clean(row.policy, 40), *rates, *([str(row.replayed)] if again else []))
        out.print(clean(scenes, 60), style="bold")
        out.print(table)


def print_finding(finding: AuditFinding, out: Console) -> None:
    """Print a difference with both values and the tolerance."""
    values = ""
    if finding.recorded is not None or finding.recomputed is not None:
        values = f": recorded {_value(finding.recorded)}, recomputed {_value(finding.recomputed)}"
        values += "" if finding.tolerance is None else f", tolerance {finding.tolerance:.2g}"
    out.print(f"  {finding.code}: {clean(finding.message, 400)}{values}")


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, list):
        return f"[{', '.join(_value(number) for number in value)}]"
    return "nothing" if value is None else clean(str(value), 100)
