"""``irsim-evals run``: let baselines or a model answer the cases, and grade the answers."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from irsim.cli.output import console, progress
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.baselines.arms import BASELINES, run_baseline
from irsim_evals.cli.choice import CasesFolder, Fresh, GoldsFolder, Wanted, chosen, end_with, read_cases, store_of
from irsim_evals.harness.arms import MODEL_ARMS, Side
from irsim_evals.harness.run import run_arm
from irsim_evals.report.comparison import compare
from irsim_evals.results import Trial, results_of, write_results
from irsim_evals.statistics import mean_pass_hat_k, wilson

__all__ = ["run", "summaries", "verdicts_text"]

_ALL_BASELINES = "baselines"
"""Name of all baselines together."""


def run(
    wanted: Wanted = None,
    arm: Annotated[
        list[str] | None,
        typer.Option(
            help="Who answers: null, retrieval, repair; baselines for these three; no-skill, skill, skill+cli, "
            "skill+mcp or skill+mcp+distractors with a model. Give it several times for several arms."
        ),
    ] = None,
    against: Annotated[
        str | None, typer.Option(metavar="ARM", help="A second arm: each case is answered by one and then the other.")
    ] = None,
    skills: Annotated[
        Path | None, typer.Option(exists=True, file_okay=False, help="Skills that agents read instead: DIR/*/SKILL.md.")
    ] = None,
    instructions: Annotated[
        Path | None, typer.Option(exists=True, dir_okay=False, help="Text that the MCP server says of itself instead.")
    ] = None,
    fresh: Fresh = None,
    trials: Annotated[
        int, typer.Option(min=1, max=1000, help="Instances of each case: fresh ones with the seeds that follow.")
    ] = 1,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder that gets results.json.")] = Path(
        "evals-results"
    ),
    model: Annotated[str | None, typer.Option(help="Model that answers, such as anthropic/claude-opus-5.")] = None,
    epochs: Annotated[int, typer.Option(min=1, max=1000, help="Attempts of the model at each instance.")] = 1,
    token_limit: Annotated[int | None, typer.Option(min=1, help="Tokens that one attempt may take.")] = None,
    cost_limit: Annotated[float | None, typer.Option(min=0, help="US dollars that one attempt may cost.")] = None,
    time_limit: Annotated[int | None, typer.Option(min=1, help="Seconds that one attempt may take.")] = None,
    replay: Annotated[
        Path | None,
        typer.Option(exists=True, help="Recording of an earlier run, or its folder of logs: replayed without network."),
    ] = None,
    grade_only: Annotated[
        bool, typer.Option(help="With --replay: grade the recorded files and call no tools.")
    ] = False,
    price: Annotated[
        tuple[float, float] | None,
        typer.Option(help="US dollars for a million tokens that are read and written, for --cost-limit."),
    ] = None,
    base_url: Annotated[str | None, typer.Option(help="Address of the Messages API.")] = None,
    verdicts: Annotated[
        Path | None, typer.Option(help="File that gets only which cases each arm passed, to compare runs by eye.")
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Let baselines or a model answer the cases, grade the answers and write results.json.

    The baselines need neither a model nor the network: ``irsim-evals run --arm baselines``. With --against, only the
    second arm gets the texts of --skills and --instructions. Exits with 0 when all arms have run, however many cases
    passed.
    """
    arms = _arms(arm)
    store = store_of(cases_folder, golds_folder)
    options: dict[str, Any] = {
        "model": model, "epochs": epochs, "token_limit": token_limit, "cost_limit": cost_limit,
        "time_limit": time_limit, "replay": replay, "replay_mode": "grade" if grade_only else "full", "price": price,
        "base_url": base_url, "log_dir": output / "logs", "store": store,
    }  # fmt: skip
    if output.exists() and not output.is_dir():
        raise ArgumentError(f"{output} is a file", "give a folder with --output")
    seeds = [fresh, *range((fresh or 0) + 1, (fresh or 0) + trials)]  # further instances have the seeds that follow
    instances, bad = read_cases(chosen(wanted, store), store, seeds)
    groups = _sides(arms, against, skills, instructions)
    done: list[Trial] = []
    for group in groups:
        with progress(" against ".join(side.label for side in group)) as report:
            if group[0].arm in BASELINES:
                done += run_baseline(group[0].arm, instances, report)
            else:
                done += run_arm(group, instances, progress=report, **options)
    path = output / "results.json"
    write_results(results_of(done, store), path)
    if verdicts is not None:
        verdicts.parent.mkdir(parents=True, exist_ok=True)
        verdicts.write_text(verdicts_text(done), encoding="utf-8")
    rows = summaries(done)
    if json_output:
        sys.stdout.write(json.dumps({"arms": rows, "results": str(path)}, ensure_ascii=False) + "\n")
    else:
        _show(rows, path)
        if against is not None:
            first, second = dict.fromkeys(trial.arm for trial in done)
            a, b = ([trial for trial in done if trial.arm == name] for name in (first, second))
            for sentence in compare(a, b, first, second).sentences:
                console().print(sentence, soft_wrap=True)
    end_with(bad)


def summaries(trials: Sequence[Trial]) -> list[dict[str, Any]]:
    """One row for each arm: trials passed with Wilson's interval, share of the requirements met, pass^k."""
    rows = []
    for arm in dict.fromkeys(trial.arm for trial in trials):
        mine = [trial for trial in trials if trial.arm == arm]
        cases: dict[str, list[bool]] = {}
        for trial in mine:
            cases.setdefault(trial.verdict.case, []).append(trial.verdict.strict)
        passed, attempts = sum(trial.verdict.strict for trial in mine), min(map(len, cases.values()))
        hat = mean_pass_hat_k([(sum(passes), len(passes)) for passes in cases.values()], attempts)
        share, low, high = (round(value, 4) for value in wilson(passed, len(mine)))
        met = round(sum(trial.verdict.rate for trial in mine) / len(mine), 4)
        rows.append({
            "arm": arm, "passed": passed, "trials": len(mine), "share": share, "low": low, "high": high,
            "requirements": met, "attempts": attempts, "pass_hat_k": round(hat, 4),
        })  # fmt: skip
    return rows


def verdicts_text(trials: Sequence[Trial]) -> str:
    """Arm → case → whether it passed, as JSON with a line for each case; fresh instances are ``case@seed``."""
    table: dict[str, dict[str, bool]] = {}
    for trial in trials:
        table.setdefault(trial.arm, {})[trial.verdict.name] = trial.verdict.strict
    return json.dumps(table, indent=1) + "\n"


def _show(rows: list[dict[str, Any]], path: Path) -> None:
    out = console()
    several = any(row["attempts"] > 1 for row in rows)
    heads = f"{'arm':22} {'passed':>9}  {'share, 95 % interval':>22}  {'requirements met':>16}"
    out.print(heads + "  pass^k" * several)
    for row in rows:
        share = f"{row['share']:.0%} ({row['low']:.0%} to {row['high']:.0%})"
        hat = f"  {row['pass_hat_k']:.0%} (k = {row['attempts']})" if several else ""
        count = f"{row['passed']}/{row['trials']}"
        out.print(f"{row['arm']:22} {count:>9}  {share:>22}  {row['requirements']:>16.0%}{hat}")
    out.print(f"wrote {path}", soft_wrap=True)


def _arms(given: list[str] | None) -> list[str]:
    """The arms that were asked for."""
    known = [*BASELINES, *MODEL_ARMS]
    if not given:
        raise ArgumentError("no arm says who answers", f"give --arm: {', '.join([_ALL_BASELINES, *known])}")
    arms: list[str] = []
    for name in given:
        if name not in known and name != _ALL_BASELINES:
            hint = suggestion(name, [_ALL_BASELINES, *known], None) or "choose one of them"
            raise ArgumentError(f"no arm is called {name!r}; there are {', '.join(known)}", hint)
        arms += BASELINES if name == _ALL_BASELINES else [name]
    return list(dict.fromkeys(arms))


def _sides(arms: list[str], against: str | None, skills: Path | None, instructions: Path | None) -> list[list[Side]]:
    """The arms with their texts; those in one list answer in turn."""
    if against is None:
        return [[Side(arm, *((None, None) if arm in BASELINES else (skills, instructions)))] for arm in arms]
    second = _arms([against])
    if len(arms) + len(second) != 2:
        raise ArgumentError("--against compares one arm with one other", "give --arm once, and one arm to --against")
    sides = [Side(arms[0]), Side(second[0], skills, instructions)]
    return [[side] for side in sides] if any(side.arm in BASELINES for side in sides) else [sides]
