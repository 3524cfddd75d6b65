"""How verdicts are printed: a table, then what failed in each case."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.cli.output import console
from irsim.common.text import clean
from irsim_evals.grader.outcome import NOT_REACHED, Cost, Outcome, Verdict
from irsim_evals.report.failures import MEANINGS, category_of, counted

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["show_verdicts"]

_FILE_WIDTH = 120
"""Width of a table that is not shown on a terminal, so that nothing is cut off."""
_WIDE = 90
"""Width of a terminal from which all columns are shown."""
_MAX_SHOWN = 300
"""Number of characters that are shown of what an assertion expected or observed."""


def show_verdicts(verdicts: Sequence[Verdict], json_output: bool) -> None:
    """Print verdicts for people, or as one line of JSON."""
    if json_output:
        sys.stdout.write(json.dumps([v.model_dump(mode="json") for v in verdicts], ensure_ascii=False) + "\n")
        sys.stdout.flush()
        return
    out = console()
    _print_table(verdicts, out)
    for verdict in verdicts:
        failed = verdict.failed()
        if failed or verdict.cost.notes:
            out.print(f"\n{verdict.name}")
        for outcome in failed:
            if outcome.observed != NOT_REACHED:
                out.print(f"  {_in_words(outcome)}", soft_wrap=True)
        not_reached = [outcome.assertion for outcome in failed if outcome.observed == NOT_REACHED]
        if not_reached:
            out.print(f"  not reached: {', '.join(not_reached)}", soft_wrap=True)
        for note in verdict.cost.notes:
            out.print(f"  note: {clean(note, _MAX_SHOWN)}", soft_wrap=True)
    passed = sum(verdict.strict for verdict in verdicts)
    out.print(f"\n{passed} of {len(verdicts)} {'case passes' if len(verdicts) == 1 else 'cases pass'}")
    for name, number in counted(map(category_of, verdicts)).items():
        out.print(f"{number:>3} {name}: {MEANINGS[name]}", soft_wrap=True)


def _print_table(verdicts: Sequence[Verdict], out: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    if not out.is_terminal:
        out.width = max(out.width, _FILE_WIDTH)
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("case", overflow="fold")
    table.add_column("verdict", no_wrap=True, min_width=4)
    wide = out.width >= _WIDE
    costs = ["calls", "errors", "tokens"] * any(verdict.cost != Cost() for verdict in verdicts)
    for heading in (*["assertions"] * wide, "share", *["fails first in"] * wide, *costs):
        table.add_column(heading, justify="left" if heading.startswith("fails") else "right", no_wrap=True)
    for verdict in verdicts:
        held = len(verdict.outcomes) - len(verdict.failed())
        numbers = [getattr(verdict.cost, name) for name in costs]
        table.add_row(
            verdict.name,
            Text("PASS", style="bold green") if verdict.strict else Text("FAIL", style="bold red"),
            *[f"{held} of {len(verdict.outcomes)}"] * wide,
            f"{verdict.rate:.0%}",
            *["" if verdict.strict else verdict.reached] * wide,
            *("?" if number is None else f"{number:,}" for number in numbers),
        )
    out.print(table)


def _in_words(outcome: Outcome) -> str:
    where = f" ({clean(outcome.yaml_path, _MAX_SHOWN)})" if outcome.yaml_path else ""
    expected, observed = (clean(text, _MAX_SHOWN) for text in (outcome.expected, outcome.observed))
    return f"{outcome.assertion}: expected {expected}; observed {observed}{where}"
