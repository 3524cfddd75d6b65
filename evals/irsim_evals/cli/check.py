"""``irsim-evals check``: say everything that is wrong with case files, where, and what to write instead."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.findings import print_diagnostics
from irsim.cli.guard import INVALID
from irsim.cli.output import console, print_json
from irsim.common.text import clean, plural
from irsim.diagnostics.diagnostic import Diagnostic, Severity
from irsim.scenario.yaml.document import load_path, text_of
from irsim.validation.validate import report
from irsim_evals.cases.reading import CaseError
from irsim_evals.cases.store import Instance, Store, case_files, golds_of, instance_of
from irsim_evals.cli.choice import CasesFolder, GoldsFolder, chosen, store_of
from irsim_evals.grader.limited import grade_answer
from irsim_evals.proof.prove import idle_assertions

__all__ = ["MIN_GOLDS", "check"]

MIN_GOLDS = 2
"""Number of golds that each case has at least."""
_IDLE = {"empty_holds": "an empty world fulfils it", "unbroken": "no change of the right answers breaks it"}
"""Meaning of what is reported of assertions that tell nothing."""
_MAX_LISTED = 10
"""Largest number of case files for which each valid file gets a line of its own."""
_MAX_FAILED = 3
"""Failed assertions of a gold that are listed."""


def check(
    wanted: Annotated[
        list[str] | None,
        typer.Argument(metavar="[FILE]...", help="Case files; or ids, categories or sets. Default: all cases."),
    ] = None,
    grade: Annotated[
        bool, typer.Option("--grade", help="Also grade the golds: two at least, and each of them must pass.")
    ] = False,
    json_output: Annotated[
        bool, typer.Option("--json", help="Print only one JSON object per file, one per line.")
    ] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Check case files without grading anything; the exit code is 2 if any of them is wrong."""
    store = store_of(cases_folder, golds_folder)
    paths = list(_paths(wanted, store))
    own = golds_folder is None and cases_folder is None
    wrong = 0
    for path in paths:
        problems, said = _look(path, (_beside(path, store) if own else store) if grade else None)
        right = not any(item.severity == "error" for item in problems)
        wrong += not right
        if json_output:
            print_json(report(str(path), problems, said if right else None), line=True)
            continue
        text = text_of(str(path)) if problems else None
        print_diagnostics(problems, text if isinstance(text, str) else None)
        if right and len(paths) <= _MAX_LISTED:
            console().print(f"{path}: valid: {said}", soft_wrap=True)
    if len(paths) > _MAX_LISTED and not json_output:
        console().print(f"{len(paths) - wrong} of {len(paths)} case files are valid")
    if wrong:
        raise typer.Exit(INVALID)


def _paths(wanted: Sequence[str] | None, store: Store) -> Iterator[Path]:
    """The files that are meant, each as it can be named from the present folder."""
    files, here = case_files(store), Path.cwd()
    for word in wanted or files:
        if word not in files and (Path(word).suffix in (".yaml", ".yml") or Path(word).is_file()):
            yield Path(word)
            continue
        for path in (files[name] for name in ([word] if word in files else chosen([word], store))):
            yield path.relative_to(here) if path.is_relative_to(here) else path


def _beside(path: Path, store: Store) -> Store:
    """Where the golds of a file lie: for files of the store as it says, else in the nearest folder of golds."""
    if path.resolve().is_relative_to(store.cases.resolve()):
        return store
    places = [parent / store.golds.name for parent in path.resolve().parents[:3]]  # a set lies in the folder of cases
    return store._replace(golds=next((place for place in places if place.is_dir()), places[len(places) > 1]))


def _look(path: Path, store: Store | None) -> tuple[list[Diagnostic], str]:
    """The problems of a case file (with a store, also of its golds), and a summary of the file if it is valid."""
    try:
        instance = instance_of(load_path(path))
    except CaseError as error:
        return error.diagnostics, ""
    said = f"case {instance.case.id}, {plural(len(instance.case.assertions()), 'assertion')}"
    if store is None:
        return [], said
    said += f", {plural(len(golds_of(instance, store)), 'gold')} in {store.golds / instance.case.id}"
    return list(_problems_of_golds(instance, path, store)), said


def _problems_of_golds(instance: Instance, path: Path, store: Store) -> Iterator[Diagnostic]:
    golds, place = golds_of(instance, store), store.golds / instance.case.id

    def problem(message: str, fix: str, severity: Severity = "error") -> Diagnostic:
        return Diagnostic("invalid-value", severity, (), message, fix=fix, file=str(path))

    if len(golds) < MIN_GOLDS:
        message = f"{place} holds {plural(len(golds), 'right answer')}, and each case needs {MIN_GOLDS} different ones"
        yield problem(message, f"write {place}/NAME/scenario.yaml, or name another folder with --golds")
    right = bool(golds)
    for gold in golds:
        verdict = grade_answer(instance, gold)
        if not verdict.strict:
            right = False
            failed = [f"{one.assertion}: {clean(one.observed, 200)}" for one in verdict.failed()[:_MAX_FAILED]]
            message = f"{place / gold.name} does not pass: {'; '.join(failed)}"
            yield problem(message, "change the answer or the assertion")
    for name, kind in idle_assertions(instance, golds) if right else ():
        yield problem(
            f"assertion {name}: {_IDLE[kind]} ({kind})", "ask for something that a wrong answer lacks", "warning"
        )
