"""``irsim benchmark``: compare policies over scenarios and seeds."""

from __future__ import annotations

import csv
import json
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from irsim.benchmarks.labels import labels_of
from irsim.benchmarks.report.rows import RANKS, rank_text, shown_ranks
from irsim.benchmarks.summary import KEYS, PERTURBED, is_summary
from irsim.cli.benchmark_run import Wanted, run_benchmark
from irsim.cli.findings import import_user_modules
from irsim.cli.options import Imports, Json, MaxObjects, Perturb, Steps, Strict
from irsim.cli.output import console, print_json
from irsim.common.text import cell, clean
from irsim.diagnostics.errors import InputError
from irsim.results.benchmark import seeds_of

if TYPE_CHECKING:
    from rich.console import Console

    from irsim.results.benchmark import BenchmarkResult, BenchmarkRow, Estimate, Proportion

__all__ = ["benchmark", "show_benchmark"]

_COLUMNS = (
    ("velocity_avg", "m/s", 2),
    ("path_length", "path m", 1),
    ("spl", "spl", 2),
    ("distance_to_human_min", "human m", 2),
)
_BETWEEN = ("contacts_between_steps", "between", 2)
"""The column that a table has if a robot touched something between two steps."""
_DIFFERENCES = (
    *((name, name, "") for name in ("success", "collision", "timeout")),
    ("time_to_goal", "time", " s"),
    ("path_length", "path", " m"),
)
"""(key of the metric, name in the line of differences, unit)."""
MAX_FAILED_SEEDS = 10
"""Number of seeds that the line of a failed combination lists."""
MAX_FAILED_LINES = 5
"""Number of such lines of a suite."""
MAX_FAILURES = 3
"""Number of reasons that the line of a failed combination lists."""
_FULL_WIDTH = 112
"""Width that the table needs with all columns [characters]."""
_MEDIUM_WIDTH = 96
"""Width that the table needs without the last column [characters]."""


def benchmark(
    files: Annotated[
        list[str] | None,
        typer.Argument(help="Scenario files (YAML), or one suite: a name or a suite file.", show_default=False),
    ] = None,
    policies: Annotated[
        str | None,
        typer.Option(
            "--policies",
            metavar="A,B,…",
            help="Policies of all robots, to compare: behaviors such as rvo,orca or '{name: orca, timeHorizon: 5}', "
            "files (model.npz), plug-ins; irsim policies lists them. The first is the reference for differences. Of a "
            "suite: names of its policies, or others.",
            show_default="as-written, or all of a suite",
        ),
    ] = None,
    behaviors: Annotated[
        str | None, typer.Option(metavar="A,B,…", help="Another name of --policies.", hidden=True)
    ] = None,
    seeds: Annotated[
        str,
        typer.Option(
            metavar="N|LIST",
            help="The seeds: their number from 0, or a list of seeds: 20, 5-9, 1,4,7. Of a suite: the number of its "
            "seeds, from its first one on, or other seeds.",
            show_default="10, or the seeds of a suite",
        ),
    ] = "",
    perturb: Perturb = None,
    steps: Steps = None,
    json_output: Json = False,
    csv_output: Annotated[
        bool, typer.Option("--csv", help="Print all metrics of every episode as comma-separated values.")
    ] = False,
    verbose: Annotated[
        bool,
        typer.Option(
            "-v", "--verbose", help="Also print all details of a suite: policies, roles, failed rows, perturbed starts."
        ),
    ] = False,
    strict: Strict = False,
    imports: Imports = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, help="Number of processes, which does not affect results. Default: all cores.", show_default=False
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            show_default=False,
            help="Run on a Ray cluster, which does not affect results: auto, ray://host:port, or host:port from one of "
            "its machines. Needs the extra `cluster`.",
        ),
    ] = None,
    max_objects: MaxObjects = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            "--output",
            metavar="DIR",
            show_default=False,
            help="Folder for the episodes and the result. A suite has .irsim/benchmarks/NAME-HASH by default.",
        ),
    ] = None,
    submission: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            show_default=False,
            help="Like -o, and make the folder of a suite a submission that others can check with irsim audit: rows, "
            "recorded episodes of a sample, versions and hashes.",
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with the interrupted benchmark in -o, else with the last one here.")
    ] = False,
    full: Annotated[bool, typer.Option("--full", help="Run all seeds of a suite.")] = False,
    protocols: Annotated[
        list[str] | None,
        typer.Option(
            "--protocol",
            metavar="NAME",
            show_default=False,
            help="Only this protocol of a suite: freeze, yield or as-written. Repeatable.",
        ),
    ] = None,
    scenarios: Annotated[
        list[str] | None,
        typer.Option(
            "--scenario",
            metavar="NAME",
            show_default=False,
            help="Only these scenarios of a suite, by their names or the name of their family. Repeatable.",
        ),
    ] = None,
) -> None:
    """Compare policies: run every scenario with every policy and the same seeds, on all cores.

    The table shows the rates of success, collision and time-out with 95 % intervals, and mean times, speeds and paths.
    --json and --csv contain all metrics. A suite and every benchmark with -o writes each episode into a folder as soon
    as it is done; after an interruption, --resume goes on there, and the results equal an undisturbed run's.
    """
    if json_output and csv_output:
        raise InputError("--json and --csv cannot be combined", "give one of them")
    if policies is not None and behaviors is not None:
        raise InputError("--policies and --behaviors are two names of one option", "give only --policies")
    if submission is not None and output is not None:
        raise InputError("--submission and -o both name the folder", "give only --submission")
    import_user_modules(imports)
    wanted = Wanted(
        files=files or [], policies=behaviors if policies is None else policies, seeds=seeds, perturb=perturb or [],
        steps=steps, strict=strict, imports=imports or [], workers=workers, cluster=cluster, max_objects=max_objects,
        folder=submission or output, resume=resume, full=full, protocols=protocols or [], scenarios=scenarios or [],
        submit=submission is not None,
    )  # fmt: skip
    result = run_benchmark(wanted)
    if json_output:
        print_json(result)
    elif csv_output:
        _print_csv(result)
    else:
        show_benchmark(result, console(), verbose=verbose)


def show_benchmark(result: BenchmarkResult, out: Console, *, verbose: bool = True) -> None:
    """Print the table of a benchmark.

    Args:
        result: Result of :func:`irsim.benchmark`.
        out: Console to print to.
        verbose: Also print all details of a suite, which its report has, too.
    """
    brief = hasattr(result, "facts") and not verbose
    if not out.is_terminal:
        out.width = max(out.width, _FULL_WIDTH)
    width = out.width
    columns = list(_COLUMNS[: 1 if width < _MEDIUM_WIDTH else 3 if width < _FULL_WIDTH else 4])
    if not any(row.metrics["distance_to_human_min"].n for row in result.rows):
        columns = [column for column in columns if column[1] != "human m"]
    if any(row.metrics[_BETWEEN[0]].mean for row in result.rows):
        columns.append(_BETWEEN)
    shown = ["time_to_goal", *(key for key, *_ in columns)]
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("scenario", no_wrap=True)
    table.add_column("behavior", no_wrap=True, overflow="ellipsis")
    for heading in ("n", "success", "collision", "timeout", "time s", *(heading for _, heading, _ in columns)):
        table.add_column(heading, justify="right", no_wrap=True)
    labels, behaviors = _labels(result.scenarios), _policies(result) or labels_of(result.behaviors)
    if result.incidents:
        out.print(f"{clean('; '.join(result.incidents), 400)}")
    last = None
    for row in result.rows:
        if last not in (None, row.scenario):
            table.add_section()
        best = row.success.rate == max(r.success.rate for r in result.rows if r.scenario == row.scenario)
        table.add_row(
            clean(labels.get(row.scenario, row.scenario), 20) if row.scenario != last else "",
            clean(behaviors[row.behavior], 24),
            str(row.episodes),
            Text(_share(row.success), style="bold green" if best and row.success.count else ""),
            Text(_share(row.collision), style="red" if row.collision.count else "dim"),
            Text(_share(row.timeout), style="yellow" if row.timeout.count else "dim"),
            _mean(row.metrics["time_to_goal"], 1, row.episodes, interval=True),
            *(_mean(row.metrics[key], digits, row.episodes) for key, _, digits in columns),
        )
        last = row.scenario
    out.print(table)
    if any(row.success.rate < 1 and row.metrics["time_to_goal"].n for row in result.rows):
        out.print("success: every robot arrived without a collision; time: of the robots that arrived, in any episode")
    for text, label in () if brief else behaviors.items():
        if label != text:
            out.print(f"{label}: {clean(text, 400)}", soft_wrap=True)
    for row in () if brief else result.rows:
        if watched := _watched_line(row):
            combination = f"{clean(labels.get(row.scenario, row.scenario), 20)}, {behaviors[row.behavior]}"
            out.print(f"watched: {combination}: {watched}")
        if roles := _roles_line(row):
            combination = f"{clean(labels.get(row.scenario, row.scenario), 20)}, {behaviors[row.behavior]}"
            out.print(f"by role: {combination}: {roles}", soft_wrap=True)
    legend = "95 % intervals: Wilson for rates, Newcombe for their differences, bootstrap for means"
    legend += "; time s: time to goal of robots that arrived"
    if any(0 < row.metrics[key].n < row.episodes for row in result.rows for key in shown):
        legend += "; (5): only 5 of the n episodes have this value"
    if any(heading == "human m" for _, heading, _ in columns):
        legend += "; human m: smallest distance to a human"
    if _BETWEEN in columns:
        legend += "; between: contacts of a robot within a step, which no end of a step shows"
    out.print(Text(legend, "dim"))
    wide = [row.scenario for row in result.rows if is_summary(row.scenario)]
    summaries = list(dict.fromkeys(wide or [row.scenario for row in result.rows[-1:]]))
    for row in result.rows:
        if row.paired and row.scenario in summaries:
            where = f"{row.scenario}: " if len(summaries) > 1 else ""
            out.print(where + _difference_line(row, behaviors[row.behavior], behaviors[result.behaviors[0]]))
    ranks = shown_ranks(result)
    for name in [name for name in summaries if name in ranks]:
        shown = [f"{behaviors[one.behavior]} {rank_text(one)}" for one in ranks[name]]
        out.print(f"{name}: {RANKS[:1].lower()}{RANKS[1:]}: {', '.join(shown)}")
    if brief:
        _show_notes([note for note in result.notes if PERTURBED not in note], out)
        failed = sum(bool(row.failed) for row in result.rows)
        rows = f"{failed} of {len(result.rows)} rows have failed episodes; " if failed else ""
        out.print(f"{rows}-v prints {'them, ' if failed else ''}policies and perturbed starts, the report has all")
    else:
        _show_details(result, out)
    out.print(Text.assemble("reproduce: ", (result.reproduce, "cyan")), soft_wrap=True)


def _show_notes(notes: list[str], out: Console) -> None:
    for note in notes:
        out.print(Text.assemble(("note: ", "bold"), clean(note, 400)))


def _show_details(result: BenchmarkResult, out: Console) -> None:
    """Print which seeds failed, and what holds for all rows."""
    labels, behaviors = _labels(result.scenarios), _policies(result) or labels_of(result.behaviors)
    failed = [row for row in result.rows if row.failed]
    suite = hasattr(result, "facts")
    for row in failed[: MAX_FAILED_LINES if suite else None]:
        failures = list(row.failures.items())[:MAX_FAILURES]
        robots = [clean(what) + (f" {n} of {row.episodes}" if row.episodes > 1 else "") for what, n in failures]
        combination = f"{clean(labels.get(row.scenario, row.scenario), 20)}, {behaviors[row.behavior]}"
        out.print(f"failed: {combination}: {seeds_of(row.failed, MAX_FAILED_SEEDS)} ({', '.join(robots)})")
    if suite and len(failed) > MAX_FAILED_LINES:
        out.print(f"failed: {len(failed) - MAX_FAILED_LINES} more rows; rates are in results.md, seeds in results.json")
    for row in [row for row in result.rows if row.incident_seeds][:MAX_FAILED_LINES]:
        combination = f"{clean(labels.get(row.scenario, row.scenario), 20)}, {behaviors[row.behavior]}"
        out.print(f"besides: {combination}: {seeds_of(row.incident_seeds, MAX_FAILED_SEEDS)}")
    _show_notes(result.notes, out)
    periods = sorted(set(result.step_time.values()))
    out.print(f"metrics are sampled in every step ({', '.join(f'{period:g} s' for period in periods)})")


def _policies(result: BenchmarkResult) -> dict[str, str]:
    """Behavior → name that a suite gives it; empty without a suite."""
    return {text: name for name, text in getattr(result, "policies", {}).items()}


def _difference_line(row: BenchmarkRow, behavior: str, reference: str) -> str:
    """Return one line with the paired differences between a behavior and the reference."""
    differences = []
    for key, name, unit in _DIFFERENCES:
        estimate = row.paired[key]
        if estimate.mean is not None:
            interval = "" if estimate.low is None else f" [{estimate.low:+.2f}, {estimate.high:+.2f}]"
            differences.append(f"{name} {estimate.mean:+.2f}{unit}{interval}{_episodes_note(estimate, row.episodes)}")
    line = ", ".join(differences) or "no common episodes"
    return f"{clean(behavior)} minus {clean(reference)}, same seeds: {line}"


def _watched_line(row: BenchmarkRow) -> str:
    """Return the means of what was watched: zones, and how long robots were seen; empty if nothing was."""
    parts = []
    for name, zone in row.zones.items():
        crossings = _mean(zone["zone_crossings"], 2, row.episodes)
        if "time_in_zone" in zone:
            parts.append(f"{clean(name, 24)} {_mean(zone['time_in_zone'], 2, row.episodes)} s, {crossings} entries")
        else:
            parts.append(f"{clean(name, 24)} {crossings} crossings (right - left)")
    if row.metrics["seen_ratio"].n:
        parts.append(f"seen {_mean(row.metrics['seen_ratio'], 2, row.episodes)} of the time")
    return "; ".join(parts)


def _roles_line(row: BenchmarkRow) -> str:
    """Return what each role reached, where several policies share the robots; empty otherwise."""
    parts = []
    for role, values in row.roles.items():
        shares = ", ".join(f"{key} {100 * (values[key].mean or 0):.0f}%" for key in ("success", "collision", "timeout"))
        time = _mean(values["time_to_goal"], 1, row.episodes)
        parts.append(f"{clean(role, 24)} ({values['robots'].mean:g}) {shares}, time {time} s")
    return "; ".join(parts)


def _share(share: Proportion) -> str:
    if share.low is None or share.high is None:
        return f"{100 * share.rate:.0f}%"
    return f"{100 * share.rate:.0f}% {100 * share.low:.0f}-{100 * share.high:.0f}"


def _mean(estimate: Estimate, digits: int, episodes: int, *, interval: bool = False) -> str:
    if estimate.mean is None:
        return "-"
    text = f"{estimate.mean:.{digits}f}"
    if interval and estimate.low is not None and estimate.high is not None:
        text += f" ±{(estimate.high - estimate.low) / 2:.{digits}f}"
    return text + _episodes_note(estimate, episodes)


def _episodes_note(estimate: Estimate, episodes: int) -> str:
    """Return the number of episodes in parentheses if fewer than all have a value."""
    return f" ({estimate.n})" if estimate.n < episodes else ""


def _labels(files: list[str]) -> dict[str, str]:
    """Return a short label for each file; full paths without suffix if the file names are not unique.

    Names that are not files, such as the texts of the scenarios of a suite, are their own labels.
    """
    stems = {name: re.sub(r"(/scenario)?\.ya?ml$", "", name) for name in files}
    short = {name: stem.rsplit("/", 1)[-1] if stem != name else name for name, stem in stems.items()}
    return short if len(set(short.values())) == len(files) else stems


def _print_csv(result: BenchmarkResult) -> None:
    first = ("scenario", "behavior", "seed", "outcome", "steps", "sim_time", "time_limit", "unreachable")
    names, facts = _policies(result), {fact.name: fact for fact in getattr(result, "facts", ())}
    varied = list(dict.fromkeys(key for fact in facts.values() for key in fact.values))
    suite = ("policy", "family", "protocol", *(f"values.{key}" for key in varied)) if facts else ()
    lines = csv.writer(sys.stdout, lineterminator="\n")
    lines.writerow([*first, *map(cell, suite), *KEYS])
    for episode in result.episodes:
        values: list[Any] = [getattr(episode, key) for key in first]
        if fact := facts.get(episode.scenario):
            values += [names[episode.behavior], fact.family, fact.protocol]
            given = [fact.values.get(key) for key in varied]
            values += [json.dumps(value) if isinstance(value, (dict, list)) else value for value in given]
        values = [cell(value) if isinstance(value, str) else value for value in values]
        lines.writerow(["" if v is None else v for v in (*values, *(episode.metrics[key] for key in KEYS))])
