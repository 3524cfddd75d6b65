"""``irsim schema``: the JSON Schema of scenario files, for editors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["schema"]


def schema(
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", metavar="FILE", help="File to write; default: the checkout's schema, else -."),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with 1 if the file is out of date.")
    ] = False,
    scenario: Annotated[
        Path | None,
        typer.Option("--for", metavar="FILE", help="Put the line by which editors find the schema on top of FILE."),
    ] = None,
) -> None:
    """Write the JSON Schema of scenario files, or connect a file to it."""
