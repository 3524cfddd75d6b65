"""Prove a grader with a fault: ``python -m tests.evals.faulty FILE OLD NEW CASE…`` prints the first wrong verdict.

The fault is put in while the module is imported; no file changes.
"""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from dataclasses import replace
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType


class _Fault(MetaPathFinder, Loader):
    """Finds one module and puts a fault into its source."""

    def __init__(self, module: str, old: str, new: str) -> None:
        self.module, self.old, self.new = module, old, new

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        if fullname != self.module:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(fullname)
        assert spec is not None
        assert spec.origin is not None
        return importlib.util.spec_from_file_location(fullname, spec.origin, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        assert module.__file__ is not None
        with open(module.__file__, encoding="utf-8") as file:
            source = file.read()
        if source.count(self.old) != 1:
            raise SystemExit(f"{module.__file__} holds {self.old!r} {source.count(self.old)} times")
        exec(compile(source.replace(self.old, self.new), module.__file__, "exec"), module.__dict__)


def main(file: str, old: str, new: str, *cases: str) -> None:
    """Try the cases with the fault until a verdict is wrong; print it, or nothing."""
    sys.meta_path.insert(0, _Fault(f"irsim_evals.{file.removesuffix('.py').replace('/', '.')}", old, new))
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
