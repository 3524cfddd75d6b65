"""The result of a benchmark as a Markdown file."""

from __future__ import annotations

import math
from collections.abc import Sequence

from irsim.benchmarks.assumptions import SWEPT
from irsim.benchmarks.incidents import placed
from irsim.benchmarks.report.rows import RANKS, policy_labels, rank_text, shown_ranks
from irsim.common.text import markdown_code, markdown_text, plural
from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, Estimate, Proportion, SuiteResult

__all__ = [
    "INTERVALS",
    "POLICIES",
    "ROLES",
    "SHOWN",
    "Table",
    "about_of",
    "cells_of",
    "citation_of",
    "classes_of",
    "columns_of",
    "differences_of",
    "facts_of",
    "footnotes_of",
    "markdown",
    "program_of",
    "ranks_of",
    "roles_of",
    "title_of",
    "zones_of",
]

_COLUMNS = (
    ("success", "success"), ("collision", "collision"), ("timeout", "timeout"), ("time_to_goal", "time [s]"),
    ("velocity_avg", "speed [m/s]"), ("path_length", "path [m]"), ("spl", "spl"), ("min_clearance", "clearance [m]"),
)  # fmt: skip
"""(key, heading) of the columns of every table."""
_SOMETIMES = (
    ("success_in_belief", "success in belief"),
    ("distance_to_human_min", "human [m]"), ("discomfort_ratio", "discomfort"),
    ("discomfort_min_dist", "discomfort [m]"),
    ("seen_ratio", "seen"), ("time_in_zone", "in zones [s]"), ("zone_crossings", "crossings of zones"),
)  # fmt: skip
"""(key, heading) of columns that a table has if a row has a value."""
_ABOVE_ZERO = (("contacts_between_steps", "between steps"),)
"""(key, heading) of columns that a table has if a row has a value other than 0."""
_DIFFERENCES = (
    ("success", "success"), ("collision", "collision"), ("timeout", "timeout"), ("time_to_goal", "time [s]"),
    ("path_length", "path [m]"),
)  # fmt: skip
SHOWN = frozenset(key for columns in (_COLUMNS, _SOMETIMES, _ABOVE_ZERO, _DIFFERENCES) for key, _ in columns)
"""Keys of all metrics that a report can show over episodes."""
INTERVALS = (
    "Intervals are 95 %: Wilson's for shares, Newcombe's for their differences, bootstrap for means. Rows over several "
    "scenarios count each episode once, and their intervals resample scenarios, too. A mean without an interval has no "
    "spread: all its values are equal, or there is only one. Times count robots that arrived."
)
"""The intervals, and how many episodes count."""
_CLEARANCE = "Contacts count within steps, but clearance is the smallest distance at the ends of steps."
POLICIES = "Policies by what they know besides their own state and goal"
"""The heading of the policies."""
ROLES = "By role: shares and means of the robots that one policy drives, each episode counted once"
"""The heading of the roles."""
Table = tuple[list[str], list[list[str]]]
"""Headings and rows of cells."""


def markdown(result: BenchmarkResult, notes: Sequence[str] = ()) -> str:
    """The file: what was run, the table with 95 % intervals, and how to run it again.

    Args:
        result: The result.
        notes: Notes on the report itself.
    """
    labels, columns = policy_labels(result), columns_of(result)
    lines = [f"# {markdown_text(title_of(result))}", "", *(f"{markdown_text(line)}  " for line in facts_of(result)), ""]
    for line in about_of(result):
        lines += [markdown_text(line), ""]
    rows = [[row.scenario, labels[row.behavior], str(row.episodes), *cells_of(row, columns)] for row in result.rows]
    lines += _table((["scenario", "policy", "n", *(heading for _, heading in columns)], rows))
    if zones := zones_of(result):
        lines += ["", "Zones, means over the robots:", "", *_table(zones)]
    if roles := roles_of(result):
        lines += ["", f"{ROLES}:", "", *_table(roles)]
    if differences := differences_of(result):
        first = markdown_text(labels[result.behaviors[0]])
        lines += ["", f"Differences to {first} with the same seeds:", "", *_table(differences)]
    if ranks := ranks_of(result):
        lines += ["", f"{RANKS}:", "", *_table(ranks)]
    lines += ["", f"{POLICIES}:", ""]
    for known, texts in classes_of(result).items():
        lines += [f"- {markdown_text(known)}:"] if known else []
        lines += [f"{'  ' * bool(known)}- {markdown_text(labels[text])}: {markdown_code(text)}" for text in texts]
    lines += ["", *(f"Note: {markdown_text(note)}  " for note in (*result.notes, *notes))]
    lines += ["", " ".join(footnotes_of(result))]
    lines += ["", f"Reproduce: {markdown_code(result.reproduce)} with {program_of(result)}"]
    lines += ["", f"Cite this run: {markdown_text(citation_of(result))}"]
    return "\n".join(lines) + "\n"


def _table(table: Table) -> list[str]:
    """The lines of a table."""
    headings, rows = table
    cells = [[markdown_text(cell) for cell in row] for row in (headings, *rows)]
    first, *others = [f"| {' | '.join(row)} |" for row in cells]
    return [first, "|---" * len(headings) + "|", *others]


def title_of(result: BenchmarkResult) -> str:
    """The heading of a report."""
    if isinstance(result, SuiteResult):
        return f"{result.suite}: {result.title}"
    return "Benchmark"


def facts_of(result: BenchmarkResult) -> list[str]:
    """The runs, in a few lines."""
    policies = "1 policy" if len(result.behaviors) == 1 else f"{len(result.behaviors)} policies"
    seeds = f"{plural(len(result.seeds), 'seed')} from {result.seeds[0]}"
    episodes = "1 episode" if len(result.episodes) == 1 else f"{len(result.episodes):,} episodes"
    lines = [f"{plural(len(result.scenarios), 'scenario')}, {policies}, {seeds}; {episodes}."]
    if isinstance(result, SuiteResult):
        hashes = f"suite hash {result.suite_hash}, run hash {result.hash}"
        lines.append(f"Suite version {result.suite_version}, {hashes}, {program_of(result)}.")
    if result.assumptions:
        lines.append(f"Taken for granted: {'; '.join(result.assumptions)}.")
    if result.incidents:
        lines.append(f"Besides outcomes: {'; '.join(result.incidents)}.")
    return lines


def program_of(result: BenchmarkResult) -> str:
    """Version and engine of the program that ran the episodes."""
    return f"irsim {result.version}" + (f", engine {result.engine}" if result.engine else "")


def citation_of(result: BenchmarkResult) -> str:
    """The words with which others cite a run: program, version, engine, and hashes of what it depends on."""
    parts = [f"irsim developers, irsim {result.version} (MIT)"]
    parts += [f"engine {result.engine}"] if result.engine else []
    if isinstance(result, SuiteResult):
        parts += [f"suite {result.suite}, version {result.suite_version}", f"suite hash {result.suite_hash}"]
        parts.append(f"run hash {result.hash}")
    return ", ".join([*parts, f"{plural(len(result.seeds), 'seed')} from {result.seeds[0]}"]) + "."


def about_of(result: BenchmarkResult) -> list[str]:
    """Description of a suite: its text, its sources, and when its episodes end; empty without a suite."""
    if not isinstance(result, SuiteResult):
        return []
    lines = [result.about] if result.about else []
    lines += ["Sources: " + "; ".join(result.sources)] if result.sources else []
    limits = sorted({episode.time_limit for episode in placed(result.episodes)})
    horizon = f"The horizon is {' or '.join(f'{limit:g}' for limit in limits)} s" if limits else ""
    ends = {
        "done": "an episode ends when every robot has arrived or stopped",
        "first_collision": "an episode ends with the first collision",
    }
    parts = [horizon, ends.get(result.until or "", "")]
    if any(parts):
        lines.append("; ".join(part for part in parts if part) + ".")
    return lines


def columns_of(result: BenchmarkResult) -> list[tuple[str, str]]:
    """Key and heading of the columns of the table: some only if a row has a value, or one other than 0."""
    used = [(key, text) for key, text in _SOMETIMES if any(_has(row.metrics.get(key)) for row in result.rows)]
    used += [
        (key, text) for key, text in _ABOVE_ZERO if any(_is_above_zero(row.metrics.get(key)) for row in result.rows)
    ]
    return [*_COLUMNS, *used]


def zones_of(result: BenchmarkResult) -> Table | None:
    """The table of zones, one row for each zone of each row; None without zones."""
    labels = policy_labels(result)
    keys = list(dict.fromkeys(key for row in result.rows for zone in row.zones.values() for key in zone))
    rows = [
        [row.scenario, labels[row.behavior], zone, *(_mean(values.get(key)) for key in keys)]
        for row in result.rows
        for zone, values in row.zones.items()
    ]
    headings = ["time_in_zone [s]" if key == "time_in_zone" else key for key in keys]
    return (["scenario", "policy", "zone", *headings], rows) if rows else None


_OF_ROLES = (
    ("success", "success"), ("collision", "collision"), ("timeout", "timeout"), ("time_to_goal", "time [s]"),
    ("restricted_time", "restricted time [s]"), ("velocity_avg", "speed [m/s]"),
)  # fmt: skip


def roles_of(result: BenchmarkResult) -> Table | None:
    """The table of roles, one row for each role of each row; None where one policy drives all robots."""
    labels = policy_labels(result)
    rows = [
        [
            row.scenario, labels[row.behavior], role, f"{values['robots'].mean:g}",
            *(_mean(values[key]) for key, _ in _OF_ROLES),
        ]
        for row in result.rows
        for role, values in row.roles.items()
    ]  # fmt: skip
    headings = [heading for _, heading in _OF_ROLES]
    return (["scenario", "policy", "role", "robots", *headings], rows) if rows else None


def differences_of(result: BenchmarkResult) -> Table | None:
    """The table of paired differences to the first policy; None with one policy."""
    labels = policy_labels(result)
    rows = [
        [
            row.scenario, labels[row.behavior], str(row.paired["success"].n),
            *(_mean(row.paired[key], "+.2f") for key, _ in _DIFFERENCES),
        ]
        for row in result.rows
        if row.paired
    ]  # fmt: skip
    return (["scenario", "policy", "pairs", *(heading for _, heading in _DIFFERENCES)], rows) if rows else None


def classes_of(result: BenchmarkResult) -> dict[str, list[str]]:
    """Class of information -> its policies; "" for policies of which it cannot be told."""
    classes: dict[str, list[str]] = {}
    for behavior in result.behaviors:
        classes.setdefault(result.information.get(behavior, ""), []).append(behavior)
    return classes


def ranks_of(result: BenchmarkResult) -> Table | None:
    """The table of ranks over several scenarios, or else of each scenario; None with fewer than three policies."""
    labels = policy_labels(result)
    ranks = shown_ranks(result)
    rows = [[name, labels[one.behavior], rank_text(one)] for name, of_row in ranks.items() for one in of_row]
    return (["scenario", "policy", "rank"], rows) if rows else None


def footnotes_of(result: BenchmarkResult) -> list[str]:
    """Sentences that a reader needs to judge the numbers."""
    swept = any(SWEPT in text for text in result.assumptions)
    return [INTERVALS, *([_CLEARANCE] if swept else [])]


def cells_of(row: BenchmarkRow, columns: Sequence[tuple[str, str]] = _COLUMNS) -> list[str]:
    """The values of a row of the table."""
    cells = []
    for key, _ in columns:
        share = getattr(row, key, None)
        cells.append(_share(share) if isinstance(share, Proportion) else _mean(row.metrics.get(key)))
    return cells


def _has(estimate: Estimate | None) -> bool:
    return estimate is not None and estimate.n > 0


def _is_above_zero(estimate: Estimate | None) -> bool:
    return estimate is not None and bool(estimate.mean)


def _share(proportion: Proportion) -> str:
    if proportion.low is None or proportion.high is None:
        return _percent(proportion.rate)
    return f"{_percent(proportion.rate)} ({_percent(proportion.low)} to {_percent(proportion.high)})"


def _percent(share: float) -> str:
    """A share in %, with a decimal where it would look like none or all and is neither."""
    text = f"{share:.0%}"
    return f"{share:.1%}" if text in ("0%", "100%") and share not in (0.0, 1.0) else text


def _mean(estimate: Estimate | None, form: str = ".2f") -> str:
    if estimate is None or estimate.mean is None:
        return ""
    if estimate.low is None or estimate.high is None or math.isclose(estimate.low, estimate.high, abs_tol=1e-12):
        return f"{estimate.mean:{form}}"
    return f"{estimate.mean:{form}} ({estimate.low:{form}} to {estimate.high:{form}})"
