"""``irsim inspect``: list recorded runs, and print tables of a recorded run."""

from __future__ import annotations

import sys
from csv import writer as csv_writer
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from irsim.cli.options import Json
from irsim.cli.output import console, print_json
from irsim.common.text import cell, clean
from irsim.results.benchmark import ending
from irsim.runs import list_runs
from irsim.runs.files import RunError
from irsim.runs.inspection import VIEWS, inspect_run

if TYPE_CHECKING:
    from irsim.results.run import RunTable

__all__ = ["inspect"]

MAX_ROWS = 20
"""Default number of rows of a table."""
MAX_CSV_TEXT_LENGTH = 200
"""Longer texts are cut off in comma-separated values [characters]."""
_FULL_WIDTH = 120
"""Width of a table outside a terminal [characters]."""


def inspect(
    run: Annotated[
        str | None,
        typer.Argument(
            help="Id or folder of a run, or 'last'. Without it, the recorded runs are listed.", show_default=False
        ),
    ] = None,
    view: Annotated[
        str,
        typer.Option(
            help="rows: states step by step; collisions: objects that touched, also within a step; closest: smallest "
            "distances between objects, edge to edge; speeds: path length, speed (forward below 0 means backwards), "
            "turn rate; zones: who entered a region or crossed a line of world.zones; sight: who saw whom (fov)."
        ),
    ] = "rows",
    robot: Annotated[
        str | None,
        typer.Option(
            "--objects",
            metavar="WHICH",
            help="Show only this object, or all, robots, obstacles, a tag, or several names separated by commas.",
            show_default=False,
        ),
    ] = None,
    from_step: Annotated[int, typer.Option("--first", min=0, metavar="STEP", help="First step.")] = 0,
    to_step: Annotated[
        int | None, typer.Option("--last", min=0, metavar="STEP", help="Last step.", show_default=False)
    ] = None,
    every: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="STEPS",
            help="Show every Nth step. Default: as many steps as fit in the table.",
            show_default=False,
        ),
    ] = None,
    fields: Annotated[
        str | None,
        typer.Option(
            metavar="A,B,…",
            help="Columns of the view rows. An unknown name prints the list of all columns.",
            show_default=False,
        ),
    ] = None,
    limit: Annotated[
        int | None, typer.Option(min=1, metavar="ROWS", help="Maximum number of rows. Default: 20; with --csv, all.")
    ] = None,
    cursor: Annotated[
        str | None, typer.Option(help="Continue after the last row of the previous table.", show_default=False)
    ] = None,
    csv: Annotated[bool, typer.Option("--csv", help="Print all rows as comma-separated values.")] = False,
    json_output: Json = False,
) -> None:
    """Print tables of a run that was recorded with `irsim run --record`.

    Lengths are in m, times in s, angles in rad.
    """
    if run is None:
        _list_runs()
        return
    if view not in VIEWS:
        raise RunError("bad-argument", f"unknown view {view!r}", f"choose one of {', '.join(VIEWS)}")
    table = inspect_run(
        run,
        view=view,
        robot=robot,
        from_step=from_step,
        to_step=to_step,
        every=every if every is not None or not csv else 1,
        fields=None if fields is None else [name.strip() for name in fields.split(",") if name.strip()],
        limit=limit if limit is not None or csv else MAX_ROWS,
        cursor=cursor,
    )
    if json_output:
        print_json(table)
    elif csv:
        _print_csv(table)
        for note in table.notes:
            typer.echo(f"note: {note}", err=True)
    else:
        _show(table, console())


def _list_runs() -> None:
    """Print the recorded runs of this folder, the latest first."""
    runs = list_runs()
    if not runs:
        typer.echo("no recorded runs here; `irsim run FILE --record` records one")
        return
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("run", "outcome", "steps", "seed", "recorded"):
        table.add_column(heading, no_wrap=True)
    table.add_column("scenario", overflow="fold")
    for run in runs[:MAX_ROWS]:
        try:
            result = run.result
            steps = run.last_step if result is None else result.steps
            outcome: str = run.status if result is None else ending(result.outcome, result.lost)
        except RunError:
            steps, outcome = -1, "unreadable"
        table.add_row(
            run.id,
            outcome,
            "-" if steps < 0 else str(steps),
            str(run.meta.get("seed")),
            clean(run.meta.get("created"))[:16].replace("T", " "),
            clean(run.meta.get("scenario") or "(text)"),
        )
    out = console()
    out.print(table)
    if len(runs) > MAX_ROWS:
        out.print(f"... and {len(runs) - MAX_ROWS} more")


def _print_csv(table: RunTable) -> None:

    writer = csv_writer(sys.stdout, lineterminator="\n")
    writer.writerow([cell(name) for name in table.columns])
    for row in table.rows:
        writer.writerow([cell(clean(v, MAX_CSV_TEXT_LENGTH)) if isinstance(v, str) else v for v in row])


def _show(table: RunTable, out: object) -> None:
    assert isinstance(out, Console)
    ended = table.status if table.outcome is None else ending(table.outcome, table.lost)
    out.print(f"{table.run_id}: {ended}: {clean(table.summary, 400)}")
    if table.lost is not None:
        out.print(f"reason: {clean(table.lost, 400)}")
    for note in table.notes:
        out.print(f"note: {clean(note, 200)}", style="yellow")
    if not out.is_terminal:
        out.width = max(out.width, _FULL_WIDTH)
    shown = Table(box=None, pad_edge=False, header_style="dim")
    for column in table.columns:
        shown.add_column(
            column,
            overflow="fold",
            no_wrap=column in ("what", "kind"),
            justify="left"
            if column in ("robot", "object", "partner", "to", "kind", "status", "zone", "what", "observer", "seen")
            else "right",
        )
    for row in table.rows:
        shown.add_row(*(_cell(value) for value in row))
    out.print(shown)
    if not (table.rows or table.notes):
        out.print("no such events in these steps")
    steps = f"steps {table.from_step} to {table.to_step}"
    if table.every > 1:
        steps += f", every {table.every} steps: use --every, --first, --last and --objects for more detail"
    more = f" of {table.total}; continue with --cursor {table.next_cursor}" if table.next_cursor else ""
    out.print(f"{len(table.rows)} rows{more}, {steps}")


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    return "-" if value is None else clean(value, 30)
