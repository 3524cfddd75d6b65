"""``irsim bridge compare-pedestrians`` and ``pedestrians-suite``: behaviors and robots beside recorded people."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from enum import Enum
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from irsim.benchmarks.suite_plan import suite_plan
from irsim.bridges.pedestrians.comparison import Row
from irsim.bridges.pedestrians.comparison import compare_pedestrians as compare
from irsim.bridges.pedestrians.imitation import GOALS, RADIUS
from irsim.bridges.pedestrians.published import RECORDINGS, write_pedestrians_suite
from irsim.cli.options import Json
from irsim.cli.output import console, existing, progress, show_written
from irsim.scenario.behavior_override import split_behaviors

__all__ = ["compare_pedestrians", "pedestrians_suite"]


class Goal(str, Enum):
    """Where people want to go."""

    recorded = "recorded"
    extrapolated = "extrapolated"
    both = "both"


def compare_pedestrians(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="ETH's obsmat.txt, or lines 'frame id x y' in metres.")
    ],
    policies: Annotated[
        str, typer.Option(metavar="BEHAVIORS", help="Behaviors with or without options, separated by commas.")
    ] = "dash,orca,sfm",
    goal: Annotated[
        Goal, typer.Option(help="Where people want to go: where their recording ends, or straight on.")
    ] = Goal.both,
    radius: Annotated[float, typer.Option(help="Radius of a pedestrian, in metres.")] = RADIUS,
    json_output: Json = False,
) -> None:
    """Say how human behaviors are: each recorded person walks 4.8 s by a behavior, among the others as recorded.

    8 rows of 0.4 s are known of a person, 12 are foretold. ADE and FDE are the mean and the last distance from where
    the person really went; contacts, speeds and distances to the nearest other are compared with the recorded ones.
    """
    goals = GOALS if goal is Goal.both else (goal.value,)
    with progress("walking") as report:
        result = compare(files, split_behaviors(policies), goals=goals, radius=radius, progress=report)
    if json_output:
        typer.echo(json.dumps(asdict(result)))
        return
    for name, share in result.contacts.items():
        rows = [row for row in result.rows if row.recording == name]
        console().print(
            f"{name}: {rows[0].likeness.cases} people, {share:.1%} of whom touch another person", soft_wrap=True
        )
        console().print(_table(rows))
    console().print(
        f"contacts: people who touch another person (radius {radius:g} m). "
        "speed, nearest: earth mover's distances from the recorded speeds and distances to the nearest other",
        soft_wrap=True,
    )


def pedestrians_suite(
    eth: Annotated[Path, typer.Option(metavar="FILE", help="obsmat.txt of seq_eth of ETH BIWI.")],
    hotel: Annotated[Path, typer.Option(metavar="FILE", help="obsmat.txt of seq_hotel of ETH BIWI.")],
    zara01: Annotated[
        Path, typer.Option(metavar="FILE", help="crowds_zara01 of UCY, as lines 'frame id x y' in metres.")
    ],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Suite to write.")] = Path(
        "pedestrians_v1.yaml"
    ),
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
    json_output: Json = False,
) -> None:
    """Write the suite pedestrians_v1, in which a robot crosses the people of three recordings that you have."""
    files = dict(zip(RECORDINGS, (eth, hotel, zara01), strict=True))
    before = existing(out)
    made = write_pedestrians_suite(files, out, overwrite=force)
    if json_output:
        typer.echo(json.dumps(asdict(made)))
        return
    windows = ", ".join(f"{count} of {name} ({made.lengths[name]:g} s)" for name, count in made.windows.items())
    show_written(made.file, f"suite hash {suite_plan(made.file).suite_hash}; windows: {windows}", before=before)
    if made.other:
        what = (
            f"{' and '.join(made.other)}: not the files of the published results (SHA-256), so its numbers are others"
        )
        console().print(Text.assemble(("note: ", "bold"), what), soft_wrap=True)
    console().print(Text.assemble("run it: ", (f"irsim benchmark {made.file}", "cyan")), soft_wrap=True)


def _table(rows: Sequence[Row]) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("behavior", "goal", "ADE m", "FDE m", "contacts", "speed m/s", "nearest m"):
        table.add_column(heading)
    for row in rows:
        one = row.likeness
        numbers = (f"{one.ade:.2f}", f"{one.fde:.2f}", f"{one.contacts:.1%}", f"{one.speed:.3f}", f"{one.nearest:.3f}")
        table.add_row(row.behavior, row.goal, *numbers)
    return table
