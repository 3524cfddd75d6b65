"""``irsim-evals schema``: write the JSON Schema of case files, or check that it is up to date."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from irsim_evals.cases.schema import schema_text

__all__ = ["schema"]

_PATH = Path("schema") / "eval-case.schema.json"


def schema(
    check: Annotated[bool, typer.Option("--check", help="Exit with 1 if the file is out of date.")] = False,
    out: Annotated[Path, typer.Option("--out", "-o", help="File to write.")] = _PATH,
) -> None:
    """Write the JSON Schema of case files, which editors use for completion."""
    text = schema_text()
    if not check:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text, encoding="utf-8")
        return
    if not out.is_file() or out.read_text(encoding="utf-8") != text:
        sys.stderr.write(f"{out} is out of date: run irsim-evals schema\n")
        raise typer.Exit(1)
    sys.stdout.write(f"{out} is up to date\n")
