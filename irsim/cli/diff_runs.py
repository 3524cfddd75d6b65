"""``irsim diff-runs``: find the first step in which two recorded runs differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from irsim.cli.guard import FAILED
from irsim.cli.options import Json
from irsim.cli.output import console, print_json
from irsim.common.text import clean
from irsim.runs import comparison

if TYPE_CHECKING:
    from irsim.results.records import RunsDiff

__all__ = ["diff_runs"]

MAX_ROWS = 20
"""Quantities and events that are shown."""


def diff_runs(
    before: Annotated[
        str, typer.Argument(metavar="[A]", help="Id or folder of a run. Default: the run before the last.")
    ] = "last-1",
    after: Annotated[
        str, typer.Argument(metavar="[B]", help="Id or folder of another run. Default: the last run.")
    ] = "last",
    tolerance: Annotated[
        float, typer.Option(min=0.0, help="Numbers that differ by at most this much count as equal.")
    ] = 0.0,
    json_output: Json = False,
) -> None:
    """Find the first step in which two recorded runs differ, and in what; the exit code is 1 if they differ.

    Without arguments it compares the last two runs. Differences of scenario, seed, version and options are listed, too,
    but do not count.
    """
    difference = comparison.diff_runs(before, after, tolerance=tolerance)
    if json_output:
        print_json(difference)
    else:
        _show(difference)
    if not difference.same:
        raise typer.Exit(FAILED)


def _show(difference: RunsDiff) -> None:
    out = console()
    for change in difference.setup:
        out.print(f"{change.key}: {clean(change.before, 100)} -> {clean(change.after, 100)}", soft_wrap=True)
        if change.key == "scenario":
            out.print("  `irsim diff` with these two files lists the keys that differ", style="dim", soft_wrap=True)
    if difference.parted:
        table = Table(box=None, pad_edge=False, header_style="dim")
        for heading in ("object", "quantity", difference.before, difference.after, "difference"):
            table.add_column(heading, overflow="fold")
        for one in difference.parted[:MAX_ROWS]:
            numbers = [_cell(one.before), _cell(one.after), "-" if one.difference is None else f"{one.difference:.3g}"]
            beams = f" and {one.beams - 1} beams" if one.beams is not None and one.beams > 1 else ""
            table.add_row(clean(one.object, 40), one.quantity + beams, *numbers)
        out.print(table)
        if difference.parted_count > MAX_ROWS:
            out.print(f"... and {difference.parted_count - MAX_ROWS} more")
    for run, count, events in zip(
        (difference.before, difference.after),
        difference.event_counts,
        (difference.events_before, difference.events_after),
        strict=True,
    ):
        for event in events[:MAX_ROWS]:
            partner = "" if event.partner is None else f" with {clean(event.partner, 40)}"
            zone = "" if event.zone is None else f" at {clean(event.zone, 40)}"
            way = "" if event.direction is None else f" ({event.direction.replace('_', ' ')})"
            who = f"{event.kind} of {clean(event.object, 40)}{partner}{zone}{way}"
            out.print(f"only in {run}: {who} at step {event.step}", soft_wrap=True)
        if count > MAX_ROWS:
            out.print(f"... and {count - MAX_ROWS} more events only in {run}")
    for note in difference.notes:
        out.print(f"note: {clean(note, 200)}", style="yellow")
    out.print(clean(difference.summary, 600), soft_wrap=True, style="green" if difference.same else "bold red")


def _cell(value: float | bool | None) -> str:
    if value is None:
        return "-"
    return ("yes" if value else "no") if isinstance(value, bool) else f"{value:.9g}"
