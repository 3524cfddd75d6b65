"""``irsim-evals cases``: list the cases, or show the prompt of one."""

from __future__ import annotations

import json
import sys
from typing import Annotated

import typer

from irsim.cli.output import console
from irsim_evals.cases.instance import Instance
from irsim_evals.cases.store import case_of
from irsim_evals.cli.choose import chosen

__all__ = ["cases"]


def cases(
    wanted: Annotated[list[str] | None, typer.Argument(metavar="[CASE]...", help="Ids or categories.")] = None,
    fresh: Annotated[int | None, typer.Option(help="Seed of a fresh instance: other numbers, names and words.")] = None,
    json_output: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List cases, or show the prompts of some."""
    instances = [case_of(name, fresh) for name in chosen(wanted)]
    if json_output:
        rows = [
            {
                "id": i.case.id,
                "title": i.case.title,
                "category": i.case.category,
                "level": i.case.level,
                "prompt": i.prompt,
            }
            for i in instances
        ]
        sys.stdout.write(json.dumps(rows, ensure_ascii=False) + "\n")
        return
    out = console()
    widths = [max(len(text) for text in column) for column in zip(*map(_columns, instances), strict=True)]
    for instance in instances:
        name, category = (text.ljust(width) for text, width in zip(_columns(instance), widths, strict=True))
        out.print(f"{name}  level {instance.case.level}  {category}  {instance.case.title}", soft_wrap=True)
        if wanted:
            out.print(f"\n{instance.prompt.strip()}\n", soft_wrap=True)


def _columns(instance: Instance) -> tuple[str, str]:
    return instance.case.id, ", ".join(instance.case.category)
