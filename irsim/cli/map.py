"""``irsim map``: import and export maps of the ROS map server."""

from __future__ import annotations

import json
import shlex
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from irsim.cli.guard import handle_errors
from irsim.cli.options import File, Imports, Json, Seed

if TYPE_CHECKING:
    from irsim.api.ros_maps import MapFiles

__all__ = ["map_app"]

map_app = typer.Typer(
    name="map", help="Import maps of the ROS map server into scenarios, and export maps.", no_args_is_help=True
)
Out = Annotated[
    Path, typer.Option("-o", "--out", metavar="FILE", help="YAML file to write; its picture is written next to it.")
]
Force = Annotated[bool, typer.Option("--force", help="Overwrite files.")]


class Unknown(str, Enum):
    """Treatment of unknown cells."""

    free = "free"
    occupied = "occupied"


class Mode(str, Enum):
    """How the map server interprets a picture."""

    trinary = "trinary"
    scale = "scale"
    raw = "raw"


class Picture(str, Enum):
    """Format of the picture."""

    pgm = "pgm"
    png = "png"


def import_(
    file: Annotated[str, typer.Argument(help="YAML file of the map.", show_default=False)],
    out: Out,
    unknown: Annotated[Unknown, typer.Option(help="How to treat cells of unknown occupancy.")] = Unknown.free,
    force: Force = False,
    json_output: Json = False,
) -> None:
    """Write a scenario with a map of the ROS map server: its extent, and its cells as a picture."""
    from irsim.api.ros_maps import import_map

    _show(import_map(file, out, unknown=unknown.value, overwrite=force), json_output, ["irsim", "render", str(out)])


def export(
    scenario: File,
    out: Out,
    mode: Annotated[Mode, typer.Option(help="How the map server interprets the picture.")] = Mode.trinary,
    image: Annotated[Picture, typer.Option(help="Format of the picture.")] = Picture.pgm,
    seed: Seed = None,
    imports: Imports = None,
    force: Force = False,
    json_output: Json = False,
) -> None:
    """Write the map of a scenario for the ROS map server: a YAML file and a picture."""
    from irsim import api
    from irsim.api.ros_maps import export_map

    api.import_modules(imports or ())
    resolved, _ = api.read_scenario(scenario, strict=False)
    files = export_map(resolved, out, mode=mode.value, image=image.value, seed=seed, overwrite=force)
    _show(files, json_output, None)


def _show(written: MapFiles, json_output: bool, next_command: list[str] | None) -> None:
    from rich.text import Text

    from irsim.cli.output import console

    if json_output:
        typer.echo(json.dumps(written.as_dict(), indent=2))
        return
    shown = console()
    size = f"{written.columns} x {written.rows} cells of {written.resolution:g} m, {written.occupied:,} occupied"
    shown.print(Text.assemble("wrote ", (" and ".join(written.files), "bold"), f": {size}"), soft_wrap=True)
    if next_command is not None:
        shown.print(Text.assemble("next: ", (shlex.join(next_command), "cyan")), soft_wrap=True)


map_app.command("import")(handle_errors(import_))
map_app.command("export")(handle_errors(export))
