"""``irsim map``: import maps from other worlds, and export maps for the ROS map server."""

from __future__ import annotations

import json
import shlex
from collections.abc import Collection
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.text import Text

from irsim import api
from irsim.bridges.maps.importing import import_map
from irsim.bridges.maps.importing import list_levels as only_list
from irsim.bridges.maps.ros_server import export_map
from irsim.cli.findings import import_user_modules
from irsim.cli.guard import again, going_on, handle_errors
from irsim.cli.options import File, Imports, Json, Seed
from irsim.cli.output import console, existing, print_json, show_written
from irsim.diagnostics.errors import InputError

if TYPE_CHECKING:
    from irsim.bridges.maps.ros_server import MapFiles
    from irsim.results.records import MapImportResult

__all__ = ["import_", "map_app"]


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
    import_user_modules(imports)
    resolved, _ = api.read_scenario(scenario, strict=False)
    before = existing(out)
    files = export_map(resolved, out, mode=mode.value, image=image.value, seed=seed, overwrite=force)
    _show(files, json_output, before)


def _show(written: MapFiles, json_output: bool, before: Collection[str]) -> None:
    if json_output:
        typer.echo(json.dumps(written.as_dict(), indent=2))
        return
    size = f"{written.columns} x {written.rows} cells of {written.resolution:g} m, {written.occupied:,} occupied"
    show_written(written.files, size, before=before)


class Unknown(str, Enum):
    """Treatment of unknown cells."""

    free = "free"
    occupied = "occupied"
    unknown = "unknown"


_SAYS = {
    "free": "count as free",
    "occupied": "count as occupied",
    "unknown": "stay unknown: planners avoid them, and beams pass",
}
"""How a scenario takes unknown cells."""


class Up(str, Enum):
    """Axis of a mesh that points up."""

    auto = "auto"
    y = "y"
    z = "z"
    minus_y = "-y"


class Lanes(str, Enum):
    """Lanes of roads."""

    drive = "drive"
    walk = "walk"
    all = "all"


def import_(
    file: Annotated[
        str,
        typer.Argument(
            help="A mesh (.glb, .gltf, .obj, .ply, .stl), Gaussian splats (.ply), a navigation mesh of Habitat "
            "(.navmesh), a USD stage (.usd, .usda, .usdc, .usdz), roads (.xodr), a world of Gazebo (.sdf, .world), a "
            "plan (.dxf, .svg), footprints (.geojson, .osm), .xml of MuJoCo or CommonRoad, or the YAML file of a map "
            "of the ROS map server.",
            show_default=False,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE",
            help="Scenario to write; its picture and where it is in the file's world are written next to it.",
        ),
    ] = None,
    list_levels: Annotated[bool, typer.Option("--list-levels", help="Only say which levels the file has.")] = False,
    level: Annotated[
        int | None,
        typer.Option(
            min=0, help="Number of the level, 0 is the lowest. Default: the largest but the roof.", show_default=False
        ),
    ] = None,
    height: Annotated[
        float | None, typer.Option(help="Height of the floor (m): the nearest level is taken.", show_default=False)
    ] = None,
    ground: Annotated[
        float | None,
        typer.Option(
            help="Height (m) of a flat ground that a mesh or a stage does not have; the robot is on it.",
            show_default=False,
        ),
    ] = None,
    seed_point: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y",
            help="A free place (m): what is connected to it is free. Default: the largest connected part.",
            show_default=False,
        ),
    ] = None,
    unknown: Annotated[
        Unknown | None,
        typer.Option(
            help="How to take cells of which nothing is known; planners avoid unknown ones, and beams pass them. "
            "Default: unknown for maps of ROS, else occupied.",
            show_default=False,
        ),
    ] = None,
    resolution: Annotated[
        float | None,
        typer.Option(
            help="Side of a cell (m). Default: 0.05, more where the map would be too large, less where walls are thin.",
            show_default=False,
        ),
    ] = None,
    headroom: Annotated[float, typer.Option(help="Free height above a floor (m).")] = 1.5,
    slope: Annotated[float, typer.Option(help="Steepest floor (deg).")] = 45.0,
    climb: Annotated[float, typer.Option(help="Highest step that is climbed (m).")] = 0.2,
    radius: Annotated[
        float,
        typer.Option(
            "--inflate", help="Distance from obstacles that becomes occupied (m); robots have their own shape."
        ),
    ] = 0.0,
    up: Annotated[
        Up,
        typer.Option(
            help="Axis that points up (-y: y points down); auto: y for glTF and OBJ, z for PLY and STL, what a "
            "stage of USD says."
        ),
    ] = Up.auto,
    rotate: Annotated[
        str | None,
        typer.Option(
            metavar="ROLL,PITCH,YAW",
            help="Turn a mesh, a stage or splats about the x, then y, then z axis of the file (deg), before --up. "
            "Default: splats are turned upright; 0,0,0: not.",
            show_default=False,
        ),
    ] = None,
    meters_per_unit: Annotated[
        float | None,
        typer.Option(
            help="Length of a unit of a mesh, a stage or splats (m), such as 0.001 for millimeters. Default: what a "
            "stage of USD says, else 1.",
            show_default=False,
        ),
    ] = None,
    opacity: Annotated[float, typer.Option(help="Splats with less opacity are left out.")] = 0.05,
    bounds: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,X,Y",
            help="Lower left and upper right corner of the part that becomes the map (m).",
            show_default=False,
        ),
    ] = None,
    root: Annotated[
        str | None,
        typer.Option(
            metavar="FOLDER",
            help="Folder with files that a world (model://table), a USD stage or a .gltf (../part.usd) names.",
            show_default=False,
        ),
    ] = None,
    lanes: Annotated[Lanes, typer.Option(help="Lanes of roads that are free.")] = Lanes.drive,
    layer: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Layer of a plan in DXF or SVG that counts; can be repeated. Default: all that are seen.",
            show_default=False,
        ),
    ] = None,
    robot: Annotated[
        bool, typer.Option("--add-robot", help="Add a robot that drives from one end of the map to the other.")
    ] = False,
    obstacles: Annotated[
        bool,
        typer.Option("--obstacles", help="Write circles, rectangles and polygons as obstacles instead of a picture."),
    ] = False,
    ros_map: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Also write a map for the ROS map server: YAML file.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files.")] = False,
    json_output: Json = False,
) -> None:
    """Write a scenario with a map made from a mesh, a navigation mesh, a USD stage, roads, or a map of ROS."""
    options: dict[str, Any] = {
        "resolution": resolution,
        "headroom": headroom,
        "slope": slope,
        "climb": climb,
        "radius": radius,
        "up": up.value,
        "rotate": None if rotate is None else _numbers(rotate, "rotation", 3, "--rotate 12.5,-3,0"),
        "level": level,
        "height": height,
        "ground": ground,
        "seed_point": None if seed_point is None else _numbers(seed_point, "seed point", 2, "--seed-point 1.5,2"),
        "unknown": None if unknown is None else unknown.value,
        "meters_per_unit": meters_per_unit,
        "opacity": opacity,
        "bounds": None if bounds is None else _numbers(bounds, "bounds", 4, "--bounds 0,0,8,6"),
        "lanes": lanes.value,
        "root": root,
        "layers": tuple(layer) if layer else None,
    }
    before = existing(out)
    with going_on(lambda: f"nothing was written; again: {again()}"):
        if list_levels:
            result = only_list(file, **options)
        elif out is None:
            raise InputError("the scenario to write is not named", "add -o scene.yaml, or --list-levels to only look")
        else:
            result = import_map(
                file, out, ros_map=ros_map, robot=robot, obstacles=obstacles, overwrite=force, **options
            )
    if json_output:
        print_json(result)
    else:
        _show_import(result, out, robot, before)


def _numbers(text: str, what: str, count: int, example: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count:
        raise InputError(f"the {what} '{text}' is not {count} numbers", f"write {example}")
    return numbers


def _show_import(result: MapImportResult, out: Path | None, robot: bool, before: Collection[str]) -> None:
    shown = console()

    def line(*parts: Any) -> None:
        shown.print(Text.assemble(*parts), soft_wrap=True)

    cells = f"{result.columns} x {result.rows} cells of {result.resolution:g} m, {result.occupied:,} occupied"
    if result.obstacles:
        cells = f"{result.obstacles:,} obstacle{'s' * (result.obstacles != 1)}; as a map {cells}"
    if result.files:
        show_written(result.files, cells, before=before)
    else:
        line(cells)
    for one in result.levels:
        kind = ", a roof or a top floor without a ceiling" if one.roof else ""
        taken = "  <- this one" if one.level == result.level else ""
        line(f"level {one.level}: floor at {one.height:.2f} m, {one.area:.1f} m² connected{kind}", (taken, "bold"))
    free = f"free: {result.free_area:.1f} m²"
    others = [area for k, area in enumerate(result.components) if k != (result.kept or 0)]
    if others:
        free += f"; other parts of this level [m²]: {', '.join(f'{area:.1f}' for area in others[:5])}"
    line(free)
    if result.unknown:
        line(f"unknown: {result.unknown:,} cells, which {_SAYS[result.unknown_as]}")
    if result.trip is not None:
        start, goal = ([round(x, 2) for x in place] for place in (result.trip.start, result.trip.goal))
        line(f"for a robot: state {start}, goal {goal}, {result.trip.clearance:g} m from obstacles all the way")
    for note in result.notes:
        shown.print(f"note: {note}", style="yellow", soft_wrap=True)
    if result.files:
        command = ["irsim", "run" if robot else "render", str(out)]
        line("next: ", (shlex.join(command), "cyan"))


map_app.command("import")(handle_errors(import_))
map_app.command("export")(handle_errors(export))
