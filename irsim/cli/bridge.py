"""``irsim bridge``: connections to other programs, and what belongs to them."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from irsim.bridges.doctor import examine
from irsim.cli import bridge_splats
from irsim.cli.bridge_bag import import_bag
from irsim.cli.bridge_pedestrians import import_pedestrians
from irsim.cli.bridge_scene import export_scene
from irsim.cli.guard import FAILED, handle_errors
from irsim.cli.options import Json
from irsim.cli.output import console
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import InputError
from irsim.options.registry import BRIDGES

__all__ = ["bridge_app"]

bridge_app = typer.Typer(
    name="bridge", help="Bridges to other programs: robots, simulators, formats of others.", no_args_is_help=True
)
_COLORS = {"ready": "green", "there": "green", "missing": "yellow", "broken": "red"}


def doctor(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME...", help="Only these bridges.", show_default=False)
    ] = None,
    json_output: Json = False,
) -> None:
    """List the bridges: which of their libraries are there, and whether these work on this machine.

    The exit code is 1 if a library is broken; one that is missing is none that you need until you use its bridge.
    """
    for name in names or ():
        if name not in BRIDGES.names():
            known = BRIDGES.names()
            raise InputError(f"{name!r} is not a bridge", suggestion(name, known, f"they are {', '.join(known)}"))
    found = examine(names or ())
    if json_output:
        typer.echo(json.dumps([asdict(one) for one in found], indent=2))
    else:
        table = Table(box=None, pad_edge=False, header_style="dim")
        for heading in ("bridge", "library", "version", "state", ""):
            table.add_column(heading)
        for one in found:
            table.add_row(
                Text(one.bridge, "bold cyan"), one.part, one.version, Text(one.state, _COLORS[one.state]),
                Text(clean(one.text, 300)),
            )  # fmt: skip
        console().print(table)
    if any(one.state == "broken" for one in found):
        raise typer.Exit(FAILED)


bridge_app.command("doctor")(handle_errors(doctor))
bridge_app.command("preview")(handle_errors(bridge_splats.preview))
bridge_app.command("page")(handle_errors(bridge_splats.page))
bridge_app.command("import-bag")(handle_errors(import_bag))
bridge_app.command("import-pedestrians")(handle_errors(import_pedestrians))
bridge_app.command("export-scene")(handle_errors(export_scene))
