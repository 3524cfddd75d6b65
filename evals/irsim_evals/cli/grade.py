"""``irsim-evals grade``: grade what agents left in exported folders, and print the verdicts."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import sys
import threading
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from irsim.cli.output import console
from irsim.common.text import clean
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.store import Instance, Store, case_files, case_of
from irsim_evals.cli.cases import PROMPT_FILE
from irsim_evals.cli.choice import CasesFolder, GoldsFolder, store_of
from irsim_evals.grader.artefact import ArtefactError, from_folder
from irsim_evals.grader.limited import grade_folder
from irsim_evals.grader.outcome import NOT_REACHED, Cost, Outcome, Verdict
from irsim_evals.report.failures import MEANINGS, category_of, counted
from irsim_evals.results import results_of, trial_of, write_results

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["Changes", "fingerprint", "grade"]

_EXPORTED = re.compile(r"([\w-]+?)(?:@(\d{1,18}))?")
"""Name of an exported folder: the id of a case, and the seed of a fresh instance."""
_PERIOD_S = 0.5
"""Time between two looks at the folders with ``--watch`` [s]."""
_FILE_WIDTH = 120
"""Width of a table that is not shown on a terminal, so that nothing is cut off."""
_WIDE = 90
"""Width of a terminal from which all columns are shown."""
_MAX_SHOWN = 300
"""Number of characters that are shown of what an assertion expected or observed."""
Fingerprint = tuple[tuple[str, int, int], ...]
"""Path, time of the last change [ns] and size [bytes] of each file."""


class _Work(NamedTuple):
    """One folder to grade: its case, and the seed of the instance."""

    folder: Path
    case: str
    seed: int | None


def grade(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Exported folder, or the folder of one case in it.")],
    case: Annotated[
        str | None, typer.Option(help="Case of a folder with another name; pub-01@7 for its fresh instance 7.")
    ] = None,
    calls: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Log of irsim-mcp --log-calls; default: calls.jsonl in the folder."),
    ] = None,
    run_programs: Annotated[
        bool,
        typer.Option("--run-programs", help="Run commands of a case, and with them programs of the answer, unguarded."),
    ] = False,
    watch: Annotated[bool, typer.Option(help="Grade again whenever a file changes, until Ctrl-C.")] = False,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="File of results to write, for report.")
    ] = None,
    arm: Annotated[str | None, typer.Option(help="Who answered, in that file; default: the name of DIR.")] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Grade what was left in the folders of an export.

    Up to 200 files of a folder are read: texts up to 2 MB, pictures and arrays up to 16 MB.
    Exits with 0 if every case passes, with 1 if one does not, with 2 if there is nothing to grade.
    """
    store = store_of(cases_folder, golds_folder)
    works = _works(folder, case, store)
    if output is not None and (output.is_dir() or not output.absolute().parent.is_dir()):
        why = "is a folder" if output.is_dir() else "lies in a folder that does not exist"
        raise ArgumentError(f"--output: {output} {why}", "give the path of a file")
    if calls is not None and not calls.is_file():
        raise ArgumentError(f"--calls: there is no file {calls}", "irsim-mcp --log-calls FILE writes one")
    if calls is not None and len(works) > 1:
        raise ArgumentError(
            f"--calls belongs to one case, and {folder} holds {len(works)}",
            "give the folder of one case, or put each file into its folder as calls.jsonl",
        )
    grader = _Grader(None if calls is None else calls.resolve(), run_programs, store)
    changes = Changes(work.folder for work in works)
    verdicts = {work.folder: grader.grade(work) for work in works}
    _show(list(verdicts.values()), json_output)
    if output is not None:
        place = folder.resolve()
        _write(output, arm or (place.parent if works[0].folder == folder else place).name, works, verdicts, store)
    if watch:
        _watch(folder, case, grader, verdicts, changes, json_output)
    if not all(verdict.strict for verdict in verdicts.values()):
        raise typer.Exit(1)


def _write(output: Path, arm: str, works: list[_Work], verdicts: Mapping[Path, Verdict], store: Store) -> None:
    instances = [case_of(work.case, work.seed, store) for work in works]
    trials = [
        trial_of(instance, verdicts[work.folder], arm, reply=_reply(instance, work.folder))
        for instance, work in zip(instances, works, strict=True)
    ]
    write_results(results_of(trials, store), output)


def _reply(instance: Instance, folder: Path) -> str:
    try:
        return from_folder(folder, turns=len(instance.requests)).reply
    except (ArtefactError, OSError):  # the verdict says so already
        return ""


def _works(folder: Path, case: str | None, store: Store) -> list[_Work]:
    """The folders to grade."""
    if not folder.is_dir():
        raise ArgumentError(f"there is no folder {folder}", "write some with irsim-evals export DIR")
    known = case_files(store)
    if case is None:
        paths = [path for path in (folder, *sorted(folder.iterdir())) if path.is_dir()]
        why = f"{folder} holds no exported case"
        fix = "write some with irsim-evals export DIR; for a folder with another name give --case ID"
    else:
        paths, why, fix = [folder], f"no case is called {case!r}", "list them with irsim-evals cases"
    works = []
    for path in paths:
        match = _EXPORTED.fullmatch(path.resolve().name if case is None else case)
        if match and match[1] in known:
            works.append(_Work(path, match[1], int(match[2]) if match[2] else None))
    if not works:
        raise ArgumentError(why, fix)
    return works


class _Grader(NamedTuple):
    """How folders are graded: with another file of calls, and with programs run."""

    calls: Path | None
    run_programs: bool
    store: Store

    def grade(self, work: _Work) -> Verdict:
        instance = case_of(work.case, work.seed, self.store)
        verdict = grade_folder(instance, work.folder, calls=self.calls, run_programs=self.run_programs)
        with contextlib.suppress(OSError, ValueError):
            if (work.folder / PROMPT_FILE).read_text(encoding="utf-8").strip() != instance.prompt.strip():
                verdict.cost.notes.append(
                    f"{PROMPT_FILE} is not the prompt of {verdict.name}; if this is the renamed folder of a fresh "
                    "instance, say which with --case ID@SEED"
                )
        return verdict


def _watch(
    folder: Path, case: str | None, grader: _Grader, verdicts: dict[Path, Verdict], changes: Changes, json_output: bool
) -> None:
    """Grade folders again after their files have changed, until Ctrl-C; ``verdicts`` has the last one of each."""
    stopped = threading.Event()

    def stop(*_: object) -> None:
        stopped.set()  # the exception is lost where Python ignores it, as in a finalizer
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGINT, stop)
    try:
        while not stopped.wait(_PERIOD_S):
            try:
                works = {work.folder: work for work in _works(folder, case, grader.store)}
            except (ArgumentError, OSError):  # folders may come and go meanwhile
                continue
            changed = changes.look(works)
            for path in changed:
                verdicts[path] = grader.grade(works[path])
            if changed:
                _show([verdicts[path] for path in changed], json_output)
    except KeyboardInterrupt:
        return
    finally:
        signal.signal(signal.SIGINT, before)


def fingerprint(folder: Path) -> Fingerprint:
    """The state of a folder, to tell it from another one, without hidden files and files that vanish meanwhile."""
    files = []
    for parent, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".") and name != "__pycache__"]
        for name in names:
            path = os.path.join(parent, name)
            try:
                state = os.lstat(path)
            except OSError:
                continue
            if not name.startswith("."):
                files.append((path, state.st_mtime_ns, state.st_size))
    return tuple(sorted(files))


class Changes:
    """Finds folders whose files have changed and then stayed the same from one look to the next.

    A file that is still being written is left alone until nothing has happened to it between two looks. The state of
    ``folders`` at the beginning counts as known.
    """

    def __init__(self, folders: Iterable[Path]) -> None:
        self._known = {folder: fingerprint(folder) for folder in folders}
        self._last = dict(self._known)

    def look(self, folders: Iterable[Path]) -> list[Path]:
        """The folders to grade again, new ones included."""
        now = {folder: fingerprint(folder) for folder in folders}
        known, last = self._known, self._last
        ready = [folder for folder in now if known.get(folder) != now[folder] == last.get(folder)]
        self._known.update((folder, now[folder]) for folder in ready)
        self._last = now
        return ready


def _show(verdicts: Sequence[Verdict], json_output: bool) -> None:
    """Print verdicts for people, or as one line of JSON."""
    if json_output:
        sys.stdout.write(json.dumps([v.model_dump(mode="json") for v in verdicts], ensure_ascii=False) + "\n")
        sys.stdout.flush()
        return
    out = console()
    _print_table(verdicts, out)
    for verdict in verdicts:
        failed = verdict.failed()
        if failed or verdict.cost.notes:
            out.print(f"\n{verdict.name}")
        for outcome in failed:
            if outcome.observed != NOT_REACHED:
                out.print(f"  {_in_words(outcome)}", soft_wrap=True)
        not_reached = [outcome.assertion for outcome in failed if outcome.observed == NOT_REACHED]
        if not_reached:
            out.print(f"  not reached: {', '.join(not_reached)}", soft_wrap=True)
        for note in verdict.cost.notes:
            out.print(f"  note: {clean(note, _MAX_SHOWN)}", soft_wrap=True)
    passed = sum(verdict.strict for verdict in verdicts)
    out.print(f"\n{passed} of {len(verdicts)} {'case passes' if len(verdicts) == 1 else 'cases pass'}")
    for name, number in counted(map(category_of, verdicts)).items():
        out.print(f"{number:>3} {name}: {MEANINGS[name]}", soft_wrap=True)


def _print_table(verdicts: Sequence[Verdict], out: Console) -> None:
    from rich.table import Table
    from rich.text import Text

    if not out.is_terminal:
        out.width = max(out.width, _FILE_WIDTH)
    table = Table(box=None, pad_edge=False, header_style="dim")
    table.add_column("case", overflow="fold")
    table.add_column("verdict", no_wrap=True, min_width=4)
    wide = out.width >= _WIDE
    costs = ["calls", "errors", "tokens"] * any(verdict.cost != Cost() for verdict in verdicts)
    for heading in (*["assertions"] * wide, "share", *["fails first in"] * wide, *costs):
        table.add_column(heading, justify="left" if heading.startswith("fails") else "right", no_wrap=True)
    for verdict in verdicts:
        held = len(verdict.outcomes) - len(verdict.failed())
        numbers = [getattr(verdict.cost, name) for name in costs]
        said = Text("PASS", style="bold green") if verdict.strict else Text("FAIL", style="bold red")
        counts = ("?" if number is None else f"{number:,}" for number in numbers)
        shown = [f"{held} of {len(verdict.outcomes)}"] * wide, ["" if verdict.strict else verdict.reached] * wide
        table.add_row(verdict.name, said, *shown[0], f"{verdict.rate:.0%}", *shown[1], *counts)
    out.print(table)


def _in_words(outcome: Outcome) -> str:
    where = f" ({clean(outcome.yaml_path, _MAX_SHOWN)})" if outcome.yaml_path else ""
    expected, observed = (clean(text, _MAX_SHOWN) for text in (outcome.expected, outcome.observed))
    return f"{outcome.assertion}: expected {expected}; observed {observed}{where}"
