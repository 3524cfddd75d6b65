"""``irsim-evals prove``: try the grader on answers of which it is known whether they are right."""

from __future__ import annotations

import json
import sys
import time
from typing import Annotated

import typer

from irsim.cli.output import console, progress
from irsim_evals.cli.choice import CasesFolder, GoldsFolder, Wanted, chosen, end_with, read_cases, store_of
from irsim_evals.grader.outcome import Outcome
from irsim_evals.proof.prove import Proof, as_case_rows, as_rows
from irsim_evals.proof.prove import prove as run_proof
from irsim_evals.proof.trials import Trial

__all__ = ["prove"]

_BARS = {"false accepts": 0.01, "false accepts of attacks": 0.002, "false rejects": 0.01}
"""Greatest share of wrong verdicts."""
MIN_REWRITES, MIN_MUTANTS = 10, 30
"""Numbers of trials of each case below which the proof says so."""


def prove(
    wanted: Wanted = None,
    quick: Annotated[bool, typer.Option(help="All golds, and a random twentieth of the rest.")] = False,
    seed: Annotated[int, typer.Option(help="Seed of the choice and of the fresh instances.")] = 0,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Prove the grader: golds and their rewrites pass, mutants of pinned facts, attacks and null agents fail.

    Exits with 1 if more than 1 % of the right answers are rejected, or of the wrong ones accepted (0.2 % of the
    attacks), if a trial got no verdict within its processor time, or if the second implementation of the commonest
    predicates disagrees.
    """
    begin = time.perf_counter()
    store = store_of(cases_folder, golds_folder)
    instances, bad = read_cases(chosen(wanted, store, sets=True), store)
    with progress("grading") as show:
        proof = run_proof([one.case.id for one in instances], store=store, quick=quick, seed=seed, progress=show)
    seconds = time.perf_counter() - begin
    if json_output:
        failures = [
            {"case": t.case, "gold": t.gold, "kind": t.kind, "operator": t.operator, "what": t.what,
             "failed": [f"{o.assertion}: {o.observed}" for o in v.failed()]}
            for t, v in proof.wrong
        ]  # fmt: skip
        report = {
            "rows": as_rows(proof), "cases": as_case_rows(proof), "wrong": failures, "left_out": dict(proof.left_out),
            "unjudged": [f"{_said_of(trial)}: {why}" for trial, why in proof.unjudged],
            "compared": dict(proof.compared),
            "disagreements": [_words_of(*item) for item in proof.disagreements],
            "seconds": round(seconds, 1),
        }  # fmt: skip
        sys.stdout.write(json.dumps(report, ensure_ascii=False) + "\n")
    else:
        _show(proof, seconds, quick)
    wrong = any(number > _BARS[name] * count for name, (number, count) in proof.rates.items())
    if wrong or proof.unjudged or proof.disagreements:
        raise typer.Exit(1)
    end_with(bad)


def _said_of(trial: Trial) -> str:
    """A trial for people."""
    return f"{trial.case}/{trial.gold} {trial.kind}, {trial.operator}: {trial.what}"


def _words_of(trial: Trial, predicate: str, outcome: Outcome) -> str:
    """A disagreement for people."""
    said = "holds" if outcome.passed else "does not hold"
    return f"{_said_of(trial)}: {outcome.assertion} ({predicate}) {said} for the grader only: {outcome.observed}"


def _show(proof: Proof, seconds: float, quick: bool) -> None:
    out = console()
    for row in as_rows(proof):
        out.print(f"{row['kind']:14} {row['operator']:24} {row['trials']:5} {row['wrong'] or '':>4}")
    for trial, verdict in proof.wrong:
        why = "; ".join(f"{one.assertion}: {one.observed}" for one in verdict.failed()[:2])
        told = f"rejected: {why}" if trial.right else "accepted"
        out.print(f"WRONG {_said_of(trial)}: {told}", soft_wrap=True)
    for trial, why in proof.unjudged:
        out.print(f"NO VERDICT {_said_of(trial)}: {why}", soft_wrap=True)
    for name, (wrong, count) in proof.rates.items():
        out.print(f"{name}: {wrong} of {count}" + (f" ({wrong / count:.2%})" if count else ""))
    for item in proof.disagreements:
        out.print(f"DISAGREE {_words_of(*item)}", soft_wrap=True)
    judged = ", ".join(f"{name} {number}" for name, number in sorted(proof.compared.items()))
    out.print(f"second implementation: {len(proof.disagreements)} disagreements, judged: {judged or 'nothing'}")
    for row in as_case_rows(proof):
        if not quick and (row["rewrites"] < MIN_REWRITES or row["mutants"] < MIN_MUTANTS):
            out.print(f"FEW {row['case']}: {row['rewrites']} rewrites, {row['mutants']} mutants")
    out.print(f"{sum(proof.left_out.values())} mutants of facts that no prompt pins or leaves free; {seconds:.0f} s")
