"""Prove a grader with a fault: ``python -m tests.evals.faulty FILE OLD NEW CASE…`` prints how many verdicts are wrong.

The fault is put in while the module is imported; no file changes.
"""

from __future__ import annotations

import importlib.util
import json
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


class _Fault(MetaPathFinder, Loader):
    """Finds one module and puts a fault into its source."""

    def __init__(self, module: str, old: str, new: str) -> None:
        self.module, self.old, self.new = module, old, new

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        if fullname != self.module:
            return None
        sys.meta_path.remove(self)
        found = importlib.util.find_spec(fullname)
        assert found is not None
        assert found.origin is not None
        return importlib.util.spec_from_file_location(fullname, found.origin, loader=self)

    def exec_module(self, module: ModuleType) -> None:
        assert module.__file__ is not None
        with open(module.__file__, encoding="utf-8") as file:
            source = file.read()
        if source.count(self.old) != 1:
            raise SystemExit(f"{module.__file__} holds {self.old!r} {source.count(self.old)} times")
        exec(compile(source.replace(self.old, self.new), module.__file__, "exec"), module.__dict__)


def main(file: str, old: str, new: str, *cases: str) -> None:
    """Prove the cases with the fault; print what is wrong as JSON."""
    sys.meta_path.insert(0, _Fault(f"irsim_evals.{file.removesuffix('.py').replace('/', '.')}", old, new))
    from irsim_evals.proof.prove import prove

    def here(work: Callable[..., Any], jobs: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
        return (work(trial, False) for trial, _ in jobs)

    proof = prove(list(cases), runner=here)
    wrong = [f"{t.case}/{t.gold} {t.kind}, {t.operator}: {t.what}" for t, _ in proof.wrong]
    print(json.dumps({"accepted": proof.false_accepts[0], "rejected": proof.false_rejects[0], "wrong": wrong[:5]}))


if __name__ == "__main__":
    main(*sys.argv[1:])
