"""``irsim-evals prove``: try the grader on answers of which it is known whether they are right."""

from __future__ import annotations

import json
import sys
import time
from typing import Annotated

import typer

from irsim.cli.output import console, progress
from irsim_evals.cli.choose import chosen
from irsim_evals.proof.prove import Proof, as_rows
from irsim_evals.proof.prove import prove as run_proof

__all__ = ["prove"]

_BAR = 0.01
"""Greatest share of wrong verdicts."""


def prove(
    wanted: Annotated[
        list[str] | None, typer.Argument(metavar="[CASE]...", help="Ids or categories; default: all.")
    ] = None,
    quick: Annotated[bool, typer.Option(help="All golds, and a random tenth of the rest.")] = False,
    seed: Annotated[int, typer.Option(help="Seed of the choice and of the fresh instances.")] = 0,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Prove the grader: golds and their rewrites pass, mutants of pinned facts and null agents fail.

    Exits with 1 if more than 1 % of the right answers are rejected, or of the wrong ones accepted.
    """
    begin = time.perf_counter()
    with progress("grading") as report:
        proof = run_proof(chosen(wanted), quick=quick, seed=seed, progress=report)
    seconds = time.perf_counter() - begin
    if json_output:
        wrong = [
            {"case": t.case, "gold": t.gold, "kind": t.kind, "operator": t.operator, "what": t.what,
             "failed": [f"{o.assertion}: {o.observed}" for o in v.failed()]}
            for t, v in proof.wrong
        ]  # fmt: skip
        told = {"rows": as_rows(proof), "wrong": wrong, "left_out": dict(proof.left_out), "seconds": round(seconds, 1)}
        sys.stdout.write(json.dumps(told, ensure_ascii=False) + "\n")
    else:
        _show(proof, seconds)
    if any(wrong > _BAR * count for wrong, count in (proof.false_accepts, proof.false_rejects)):
        raise typer.Exit(1)


def _show(proof: Proof, seconds: float) -> None:
    out = console()
    for row in as_rows(proof):
        out.print(f"{row['kind']:14} {row['operator']:24} {row['trials']:5} {row['wrong'] or '':>4}")
    for trial, verdict in proof.wrong:
        why = "; ".join(f"{one.assertion}: {one.observed}" for one in verdict.failed()[:2])
        told = f"rejected: {why}" if trial.right else "accepted"
        out.print(
            f"WRONG {trial.case}/{trial.gold} {trial.kind}, {trial.operator}: {trial.what}: {told}", soft_wrap=True
        )
    for name, (wrong, count) in (("false accepts", proof.false_accepts), ("false rejects", proof.false_rejects)):
        out.print(f"{name}: {wrong} of {count}" + (f" ({wrong / count:.2%})" if count else ""))
    out.print(f"{sum(proof.left_out.values())} mutants of facts that no prompt pins or leaves free; {seconds:.0f} s")
