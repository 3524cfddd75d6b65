"""Prove a grader with a fault: ``python -m tests.evals.faulty FILE OLD NEW CASE…`` prints the first wrong verdict.

The fault is put in while the module is imported; no file changes.
"""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path


def put_in(module: str, old: str, new: str) -> None:
    """Import a module with a fault in its source, before anything else imports it."""
    spec = importlib.util.find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    source = Path(spec.origin).read_text(encoding="utf-8")
    if source.count(old) != 1:
        raise SystemExit(f"{spec.origin} holds {old!r} {source.count(old)} times")
    sys.modules[module] = importlib.util.module_from_spec(spec)
    exec(compile(source.replace(old, new), spec.origin, "exec"), sys.modules[module].__dict__)


def main(file: str, old: str, new: str, *cases: str) -> None:
    """Try the cases with the fault until a verdict is wrong; print it, or nothing."""
    put_in(f"irsim_evals.{file.removesuffix('.py').replace('/', '.')}", old, new)
    from irsim_evals.grader.outcome import NOT_REACHED
    from irsim_evals.proof.prove import tried
    from irsim_evals.proof.trials import trials_of

    for trial in (trial for case in cases for trial in trials_of(case, Counter())):
        result = tried(trial, False)
        if result is None:
            continue
        kind, verdict, second = result
        right = replace(trial, kind=kind).right
        told = {o["assertion"]: o["passed"] for o in verdict["outcomes"] if o["observed"] != NOT_REACHED}
        other = [name for name, passed in second.items() if name in told and told[name] != passed]
        if verdict["strict"] != right or other:
            what = "disagreed" if verdict["strict"] == right else "rejected" if right else "accepted"
            print(f"{what}: {trial.case}/{trial.gold} {kind}, {trial.operator}: {trial.what}")
            return


if __name__ == "__main__":
    main(*sys.argv[1:])
