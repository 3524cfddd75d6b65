"""``irsim-evals export``: a folder for each case, for any agent or person to work in."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from irsim.diagnostics.errors import ArgumentError
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import case_of, write_given
from irsim_evals.cli.choose import chosen

__all__ = ["PROMPT_FILE", "export", "write_case"]

PROMPT_FILE = "prompt.md"
"""File with the prompt of a case."""


def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder to write to; it is made.")],
    wanted: Annotated[
        list[str] | None, typer.Argument(metavar="[CASE]...", help="Ids or categories; default: all.")
    ] = None,
    fresh: Annotated[
        int | None, typer.Option(min=0, max=10**18 - 1, help="Seed of fresh instances: other numbers, names and words.")
    ] = None,
) -> None:
    """Write a folder for each case: its prompt, and the files that it starts with.

    The agent works in the folder and leaves its scenario there, and its last message in ``reply.md``. What the user
    says later is in ``prompt-2.md`` and so on: open each after the reply to the one before, and save that reply as
    ``reply-1.md``.
    """
    instances = [case_of(name, fresh) for name in chosen(wanted)]
    taken = [i.case.id for i in instances if (folder / _name(i)).exists()]
    if taken:
        raise ArgumentError(f"{folder} holds {', '.join(taken[:3])} already", "choose another folder")
    for instance in instances:
        write_case(folder / _name(instance), instance)
    sys.stdout.write(f"{len(instances)} {'case' if len(instances) == 1 else 'cases'} in {folder}\n")


def _name(instance: Instance) -> str:
    return instance.case.id + (f"@{instance.name}" if instance.name else "")


def write_case(folder: Path, instance: Instance) -> None:
    """Write what an agent gets: the prompt, later turns in files of their own, and the files of the case."""
    folder.mkdir(parents=True)
    (folder / PROMPT_FILE).write_text(instance.prompt.strip() + "\n", encoding="utf-8")
    for number, turn in enumerate(instance.case.turns, 2):
        (folder / f"prompt-{number}.md").write_text(turn.strip() + "\n", encoding="utf-8")
    write_given(folder, instance)
