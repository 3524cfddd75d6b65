"""``irsim-evals grade``: grade what agents left in exported folders."""

from __future__ import annotations

import json
import re
import sys
import time
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.output import console
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import case_ids, case_of
from irsim_evals.grader.limited import grade_folder
from irsim_evals.grader.outcome import Verdict

__all__ = ["grade"]

_EXPORTED = re.compile(r"([\w-]+?)(?:@(\d+))?")
_PERIOD_S = 1.0
"""Time between two looks at the folders with ``--watch``."""


def grade(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Exported folder, or the folder of one case in it.")],
    case: Annotated[str | None, typer.Option(help="Case of a folder with another name.")] = None,
    watch: Annotated[bool, typer.Option(help="Grade again whenever a file changes, until Ctrl-C.")] = False,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Grade what was left in the folders of an export.

    Exits with 0 if every case passes, with 1 if one does not, with 2 if there is nothing to grade.
    """
    verdicts = _grade(folder, case)
    _show(verdicts, json_output)
    if watch:
        _watch(folder, case, json_output)
    if not all(verdict.strict for verdict in verdicts):
        raise typer.Exit(1)


def _folders(folder: Path, case: str | None) -> list[tuple[Path, str, int | None]]:
    """Folders to grade, with their case and the seed of its instance."""
    known = set(case_ids())
    if case is not None:
        if case not in known:
            raise ArgumentError(f"no case is called {case!r}", "list them with irsim-evals cases")
        return [(folder, case, None)]
    candidates = [folder, *sorted(folder.iterdir())] if folder.is_dir() else []
    found = []
    for path in candidates:
        name = _EXPORTED.fullmatch(path.resolve().name)
        if path.is_dir() and name is not None and name[1] in known:
            found.append((path, name[1], int(name[2]) if name[2] else None))
    if not found:
        raise ArgumentError(f"{folder} holds no exported case", "write some with irsim-evals export DIR")
    return found


def _grade(folder: Path, case: str | None) -> list[Verdict]:
    return [grade_folder(case_of(name, seed), path) for path, name, seed in _folders(folder, case)]


def _show(verdicts: list[Verdict], json_output: bool) -> None:
    if json_output:
        sys.stdout.write(json.dumps([v.model_dump(mode="json") for v in verdicts], ensure_ascii=False) + "\n")
        return
    out = console()
    for verdict in verdicts:
        mark = "PASS" if verdict.strict else "FAIL"
        out.print(f"{mark} {verdict.case}: {verdict.rate:.0%} of the assertions hold", soft_wrap=True)
        for one in verdict.failed():
            where = f" ({one.yaml_path})" if one.yaml_path else ""
            out.print(f"     {one.assertion}: expected {one.expected}; observed {one.observed}{where}", soft_wrap=True)
    passed = sum(verdict.strict for verdict in verdicts)
    out.print(f"{passed} of {len(verdicts)} cases pass")


def _watch(folder: Path, case: str | None, json_output: bool) -> None:
    seen = _stamp(folder)
    while True:
        time.sleep(_PERIOD_S)
        now = _stamp(folder)
        if now != seen:
            seen = now
            _show(_grade(folder, case), json_output)


def _stamp(folder: Path) -> list[tuple[str, int, int]]:
    found = []
    for path in sorted(folder.rglob("*")):
        try:
            state = path.lstat()
        except OSError:
            continue
        found.append((str(path), state.st_mtime_ns, state.st_size))
    return found
