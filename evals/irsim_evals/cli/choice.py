"""The cases that a command is about: the folders where they lie, and the ids, categories and sets that are named."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.findings import print_diagnostics
from irsim.cli.guard import INVALID
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.reading import CaseError
from irsim_evals.cases.store import PUBLISHED, Instance, Store, case_files, case_ids, case_of, raw_case, sets_of

__all__ = ["CasesFolder", "Fresh", "GoldsFolder", "Wanted", "chosen", "end_with", "read_cases", "store_of"]

CasesFolder = Annotated[
    Path | None,
    typer.Option("--cases", metavar="DIR", exists=True, file_okay=False, help="Folder of cases; default: ours."),
]
GoldsFolder = Annotated[
    Path | None,
    typer.Option(
        "--golds", metavar="DIR", exists=True, file_okay=False,
        help="Folder of right answers, <case>/<answer>/; default: golds beside the folder of cases.",
    ),
]  # fmt: skip
Fresh = Annotated[
    int | None, typer.Option(min=0, max=10**18 - 1, help="Seed of fresh instances: other numbers, names and words.")
]
Wanted = Annotated[list[str] | None, typer.Argument(metavar="[CASE]...", help="Ids, categories or sets; default: all.")]


def store_of(cases: Path | None, golds: Path | None) -> Store:
    """The store that the options mean."""
    if cases is None:
        return Store(PUBLISHED.cases, golds or PUBLISHED.golds)
    return Store(cases, golds or cases.resolve().parent / PUBLISHED.golds.name)


def chosen(wanted: Sequence[str] | None, store: Store = PUBLISHED, *, sets: bool = False) -> list[str]:
    """Ids of the cases that the words of a user mean, by id, category or set; without words all, perhaps with sets.

    Raises:
        ArgumentError: No case has that id, category or set.
    """
    if not wanted:
        ids = case_ids(store, sets=sets)
        if not ids:
            raise ArgumentError(f"there is no case in {store.cases}", "give --cases a folder that holds <case>.yaml")
        return ids
    known = case_files(store)
    labels = {name: {*sets_of(path, store), *_categories(name, store)} for name, path in known.items()}
    ids = []
    for word in wanted:
        meant = [word] if word in known else [name for name, own in labels.items() if word in own]
        if not meant:
            words = dict.fromkeys((*known, *(label for own in labels.values() for label in sorted(own))))
            hint = suggestion(word, words, None) or "list them with irsim-evals cases"
            raise ArgumentError(f"no case, category or set is called {word!r}", hint)
        ids += meant
    return list(dict.fromkeys(ids))


def _categories(name: str, store: Store) -> list[str]:
    data = raw_case(name, store)
    category = data.get("category") if isinstance(data, dict) else None
    return [word for word in category if isinstance(word, str)] if isinstance(category, list) else []


def read_cases(
    names: Iterable[str], store: Store, seeds: Sequence[int | None] = (None,)
) -> tuple[list[Instance], list[str]]:
    """Instances of cases, and the names of those whose files are wrong; what is wrong with them is printed.

    Raises:
        CaseError: The only case is wrong.
    """
    instances: list[Instance] = []
    bad: dict[str, CaseError] = {}
    for name in names:
        try:
            instances += [case_of(name, seed, store) for seed in seeds]
        except CaseError as error:
            bad[name] = error
    if len(bad) == 1 and not instances:
        raise next(iter(bad.values()))
    for one in bad.values():
        print_diagnostics(one.diagnostics, one.source, stderr=True)
    if not instances:
        end_with(list(bad))
    return instances, list(bad)


def end_with(bad: Sequence[str]) -> None:
    """End a command that has left out cases."""
    if bad:
        typer.echo(f"left out: {', '.join(bad)}", err=True)
        raise typer.Exit(INVALID)
