"""``irsim map``: import maps from other worlds, and export maps for the ROS map server."""

from __future__ import annotations

import json
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.text import Text

from irsim import api
from irsim.bridges.maps.ros_server import export_map
from irsim.cli.guard import handle_errors
from irsim.cli.map_import import import_
from irsim.cli.options import File, Imports, Json, Seed
from irsim.cli.output import console

if TYPE_CHECKING:
    from irsim.bridges.maps.ros_server import MapFiles

__all__ = ["map_app"]

map_app = typer.Typer(
    name="map",
    help="Import maps from other worlds into scenarios: meshes, navigation meshes, USD, roads, ROS; and export maps.",
    no_args_is_help=True,
)


class Mode(str, Enum):
    """How the map server interprets a picture."""

    trinary = "trinary"
    scale = "scale"
    raw = "raw"


class Picture(str, Enum):
    """Format of the picture."""

    pgm = "pgm"
    png = "png"


def export(
    scenario: File,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE", help="YAML file to write; its picture is written next to it.")
    ],
    mode: Annotated[Mode, typer.Option(help="How the map server interprets the picture.")] = Mode.trinary,
    image: Annotated[Picture, typer.Option(help="Format of the picture.")] = Picture.pgm,
    seed: Seed = None,
    imports: Imports = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files.")] = False,
    json_output: Json = False,
) -> None:
    """Write the map of a scenario for the ROS map server: a YAML file and a picture."""
    api.import_modules(imports or ())
    resolved, _ = api.read_scenario(scenario, strict=False)
    files = export_map(resolved, out, mode=mode.value, image=image.value, seed=seed, overwrite=force)
    _show(files, json_output)


def _show(written: MapFiles, json_output: bool) -> None:

    if json_output:
        typer.echo(json.dumps(written.as_dict(), indent=2))
        return
    size = f"{written.columns} x {written.rows} cells of {written.resolution:g} m, {written.occupied:,} occupied"
    console().print(Text.assemble("wrote ", (" and ".join(written.files), "bold"), f": {size}"), soft_wrap=True)


map_app.command("import")(handle_errors(import_))
map_app.command("export")(handle_errors(export))
