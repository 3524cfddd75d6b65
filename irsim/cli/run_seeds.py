"""``irsim run --seeds``: an episode for each of several seeds, and the first one that failed."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

import typer
from rich.table import Table
from rich.text import Text

from irsim.api.run_seeds import run_seeds
from irsim.cli.findings import print_warnings
from irsim.cli.guard import FAILED, ended_in_order
from irsim.cli.output import OUTCOME_COLORS, console, print_json, progress
from irsim.common.text import clean, seconds
from irsim.diagnostics.errors import InputError
from irsim.results.run import RunResult, RunsResult

__all__ = ["run_all"]

_MAX_SHOWN = 30
"""Number of episodes that the table lists."""


def run_all(
    file: str, seeds: str, single: Mapping[str, Any], *, json_output: bool, require_success: bool, **options: Any
) -> None:
    """Run all seeds, and print a table of the episodes.

    Args:
        file: The scenario.
        seeds: As the user wrote them.
        single: Options of a single run → their values.
        json_output: Print the result as JSON.
        require_success: Exit with code 1 unless every episode succeeded.
        **options: Arguments of :func:`irsim.api.run_seeds.run_seeds`.
    """
    if given := [name for name, value in single.items() if value is not None and value is not False]:
        raise InputError(f"{given[0]} is about one run, and --seeds about several", "give one of them")
    with ended_in_order(), progress("simulating") as report:
        result = run_seeds(file, seeds=seeds, progress=report, **options)
    if json_output:
        print_json(result)
    else:
        print_warnings(result.warnings, file)
        _show(result)
    if require_success and (result.failed or result.crowded):
        raise typer.Exit(FAILED)


def _show(result: RunsResult) -> None:
    out = console()
    table = Table(box=None, pad_edge=False, header_style="dim")
    for heading in ("seed", "outcome", "ended", "because"):
        table.add_column(heading)
    for one in result.episodes[:_MAX_SHOWN]:
        why = clean(one.reason or "", 200)
        table.add_row(str(one.seed), Text(one.outcome, style=OUTCOME_COLORS[one.outcome]), seconds(one.sim_time), why)
    out.print(table)
    if len(result.episodes) > _MAX_SHOWN:
        out.print(f"... and {len(result.episodes) - _MAX_SHOWN} more episodes (--json lists all)")
    out.print(clean(result.summary, 400))
    if result.failed:
        shown = result.shown
        out.print(Text.assemble("look: ", (_look(result, shown), "cyan")), soft_wrap=True)
        out.print(Text.assemble("reproduce: ", (shown.reproduce, "cyan")), soft_wrap=True)


def _look(result: RunsResult, shown: RunResult) -> str:
    """The command that draws the moment in which an episode was decided."""
    step = shown.decisive_step or shown.steps
    if shown.run_id is not None:
        return f"irsim render {shown.run_id} --step {step} -o failed.png"
    if shown.perturb:  # which only a record can repeat in a picture
        return f"{shown.reproduce} --record && irsim render last --step {step} -o failed.png"
    extra = ["--policy", shown.policy or shown.behavior] if shown.policy or shown.behavior else []
    words = ["irsim", "render", result.scenario, "--seed", str(shown.seed), *extra, "--step", str(step)]
    return shlex.join([*map(str, words), "-o", "failed.png"])
