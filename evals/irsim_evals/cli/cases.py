"""``irsim-evals cases``, ``export`` and ``schema``: the cases as a list, as folders to work in, and as JSON Schema."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.guard import FAILED
from irsim.cli.output import console
from irsim.cli.schema import is_current
from irsim.common.text import plural
from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.schema import schema_text
from irsim_evals.cases.store import Instance, write_given
from irsim_evals.cli.choice import CasesFolder, Fresh, GoldsFolder, Wanted, chosen, end_with, read_cases, store_of
from irsim_evals.grader.outcome import name_of

__all__ = ["PROMPT_FILE", "cases", "export", "schema", "write_case"]

PROMPT_FILE = "prompt.md"
"""File with the prompt of a case."""
_PATH = Path("schema") / "eval-case.schema.json"


def cases(
    wanted: Wanted = None,
    fresh: Fresh = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """List cases, or show the prompts of some."""
    store = store_of(cases_folder, golds_folder)
    instances, bad = read_cases(chosen(wanted, store, sets=True), store, [fresh])
    if json_output:
        keys = {"id", "title", "category", "level"}
        rows = [i.case.model_dump(include=keys) | {"prompt": i.prompt} for i in instances]
        sys.stdout.write(json.dumps(rows, ensure_ascii=False) + "\n")
        return end_with(bad)
    out = console()
    names, categories = [i.case.id for i in instances], [", ".join(i.case.category) for i in instances]
    first, second = max(map(len, names)), max(map(len, categories))
    for instance, name, category in zip(instances, names, categories, strict=True):
        line = f"{name:{first}}  level {instance.case.level}  {category:{second}}  {instance.case.title}"
        out.print(line, soft_wrap=True)
        if wanted:
            out.print(f"\n{instance.prompt.strip()}\n", soft_wrap=True)
    return end_with(bad)


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to write to; it is made.")],
    wanted: Wanted = None,
    fresh: Fresh = None,
    cases_folder: CasesFolder = None,
    golds_folder: GoldsFolder = None,
) -> None:
    """Write a folder for each case: its prompt, and the files that it starts with.

    The agent works in the folder and leaves its scenario there, and its last message in ``reply.md``. Later messages
    of the user are in ``prompt-2.md`` and so on: open each after the reply to the one before, and save that reply as
    ``reply-1.md``.
    """
    store = store_of(cases_folder, golds_folder)
    instances, bad = read_cases(chosen(wanted, store), store, [fresh])
    taken = [i.case.id for i in instances if (folder / name_of(i.case.id, i.name)).exists()]
    if taken:
        raise ArgumentError(f"{folder} holds {', '.join(taken[:3])} already", "choose another folder")
    for instance in instances:
        write_case(folder / name_of(instance.case.id, instance.name), instance)
    sys.stdout.write(f"{plural(len(instances), 'case')} in {folder}\n")
    end_with(bad)


def write_case(folder: Path, instance: Instance) -> None:
    """Write what an agent gets: the prompt, later turns in files of their own, and the files of the case."""
    folder.mkdir(parents=True)
    (folder / PROMPT_FILE).write_text(instance.prompt.strip() + "\n", encoding="utf-8")
    for number, turn in enumerate(instance.case.turns, 2):
        (folder / f"prompt-{number}.md").write_text(turn.strip() + "\n", encoding="utf-8")
    write_given(folder, instance)


def schema(
    check: Annotated[bool, typer.Option("--check", help="Exit with 1 if the file is out of date.")] = False,
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write.")] = _PATH,
) -> None:
    """Write the JSON Schema of case files, which editors use for completion."""
    if not is_current(out, schema_text(), check, "irsim-evals schema"):
        raise typer.Exit(FAILED)
