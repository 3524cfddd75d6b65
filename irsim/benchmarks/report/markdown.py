"""The result of a benchmark as a Markdown file."""

from __future__ import annotations

from collections.abc import Sequence

from irsim.benchmarks.report.names import policy_labels
from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, Estimate, Proportion
from irsim.results.suite import SuiteResult

__all__ = ["COLUMNS", "cells_of", "markdown"]

COLUMNS = (
    ("success", "success"), ("collision", "collision"), ("timeout", "timeout"), ("time_to_goal", "time [s]"),
    ("velocity_avg", "speed [m/s]"), ("path_length", "path [m]"), ("spl", "spl"), ("min_clearance", "clearance [m]"),
)  # fmt: skip
"""(key, heading) of the columns of the table."""


def markdown(result: BenchmarkResult, notes: Sequence[str] = ()) -> str:
    """The file: what was run, the table with 95 % intervals, and how to run it again.

    Args:
        result: The result.
        notes: Notes on the report itself.
    """
    labels = policy_labels(result)
    lines = [f"# {title_of(result)}", "", *(f"{line}  " for line in facts_of(result)), ""]
    lines += ["| scenario | policy | n | " + " | ".join(heading for _, heading in COLUMNS) + " |"]
    lines += ["|---" * (3 + len(COLUMNS)) + "|"]
    lines += [
        f"| {row.scenario} | {labels[row.behavior]} | {row.episodes} | {' | '.join(cells_of(row))} |"
        for row in result.rows
    ]
    lines += ["", "Policies:", "", *(f"- {label}: `{text}`" for text, label in labels.items())]
    lines += ["", *(f"Note: {note}  " for note in (*result.notes, *notes))]
    lines += [
        "", "Intervals are 95 %: Wilson's for shares, bootstrap for means. Times are those of robots that arrived.", "",
        f"Reproduce: `{result.reproduce}` with irsim {result.version}",
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def title_of(result: BenchmarkResult) -> str:
    """The heading of a report."""
    if isinstance(result, SuiteResult):
        return f"{result.suite}: {result.title}"
    return "Benchmark"


def facts_of(result: BenchmarkResult) -> list[str]:
    """What was run, in a few lines."""
    count = len(result.seeds)
    size = f"{len(result.scenarios)} scenarios, {len(result.behaviors)} policies, {count} seeds from {result.seeds[0]}"
    lines = [f"{size}; {len(result.episodes):,} episodes."]
    if isinstance(result, SuiteResult):
        hashes = f"suite hash {result.suite_hash}, run hash {result.hash}"
        lines.append(f"Suite version {result.suite_version}, {hashes}, irsim {result.version}.")
    if result.incidents:
        lines.append(f"Besides outcomes: {'; '.join(result.incidents)}.")
    return lines


def cells_of(row: BenchmarkRow) -> list[str]:
    """The values of a row of the table."""
    cells = []
    for key, _ in COLUMNS:
        share = getattr(row, key, None)
        cells.append(_share(share) if isinstance(share, Proportion) else _mean(row.metrics.get(key)))
    return cells


def _share(found: Proportion) -> str:
    if found.low is None or found.high is None:
        return f"{found.rate:.0%}"
    return f"{found.rate:.0%} ({found.low:.0%} to {found.high:.0%})"


def _mean(found: Estimate | None) -> str:
    if found is None or found.mean is None:
        return ""
    if found.low is None or found.high is None:
        return f"{found.mean:.2f}"
    return f"{found.mean:.2f} ({found.low:.2f} to {found.high:.2f})"
