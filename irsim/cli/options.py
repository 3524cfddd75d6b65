"""Options that several verbs share."""

from __future__ import annotations

from typing import Annotated

import typer

__all__ = ["File", "Imports", "Json", "MaxObjects", "Seed", "Steps", "Strict"]

File = Annotated[str, typer.Argument(help="Scenario file (YAML).", show_default=False)]
Seed = Annotated[
    int | None,
    typer.Option(
        min=0, max=2**64 - 1, help="Seed of all randomness; default: the scenario's, else a fresh one that is reported."
    ),
]
Steps = Annotated[
    int | None,
    typer.Option(min=0, help="Most steps to simulate; default: the scenario's time limit.", show_default=False),
]
Strict = Annotated[bool, typer.Option("--strict", help="Refuse what IR-SIM would ignore, such as unknown keys.")]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON and nothing else on standard output.")]
Imports = Annotated[
    list[str] | None,
    typer.Option(
        "--import", metavar="MODULE", help="Import a module first, for the behaviors it registers. Repeatable."
    ),
]
MaxObjects = Annotated[
    int | None,
    typer.Option(min=1, help="Most objects a scenario may have; default 100000.", show_default=False),
]
