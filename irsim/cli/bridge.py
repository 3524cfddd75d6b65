"""``irsim bridge``: connections to other programs, and what belongs to them."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table
from rich.text import Text

from irsim.bridges.doctor import examine
from irsim.bridges.ros.bags.importing import BagOptions
from irsim.bridges.ros.bags.importing import import_bag as convert
from irsim.bridges.usd.files import export_scene as write
from irsim.cli import bridge_splats
from irsim.cli.bridge_likeness import compare_pedestrians, pedestrians_suite
from irsim.cli.bridge_pedestrians import import_pedestrians
from irsim.cli.guard import FAILED, handle_errors
from irsim.cli.options import Json, seed_option
from irsim.cli.output import console, existing, show_written
from irsim.common.text import clean
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import InputError
from irsim.options.registry import BRIDGES

__all__ = ["bridge_app", "export_scene", "import_bag"]


bridge_app = typer.Typer(
    name="bridge", help="Bridges to other programs: robots, simulators and their formats.", no_args_is_help=True
)
_COLORS = {"ready": "green", "there": "green", "missing": "yellow", "broken": "red"}


def doctor(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME...", help="Only these bridges.", show_default=False)
    ] = None,
    json_output: Json = False,
) -> None:
    """List the bridges: which of their libraries are there, and whether these work on this machine.

    The exit code is 1 if a library is broken; a missing one is needed only when you use its bridge.
    """
    for name in names or ():
        if name not in BRIDGES.names():
            known = BRIDGES.names()
            raise InputError(f"{name!r} is not a bridge", suggestion(name, known, f"they are {', '.join(known)}"))
    reports = examine(names or ())
    if json_output:
        typer.echo(json.dumps([asdict(one) for one in reports], indent=2))
    else:
        table = Table(box=None, pad_edge=False, header_style="dim")
        for heading in ("bridge", "library", "version", "state", ""):
            table.add_column(heading)
        for one in reports:
            table.add_row(
                Text(one.bridge, "bold cyan"), one.part, one.version, Text(one.state, _COLORS[one.state]),
                Text(clean(one.text, 300)),
            )  # fmt: skip
        console().print(table)
    if any(one.state == "broken" for one in reports):
        raise typer.Exit(FAILED)


def import_bag(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="Folder of rosbag2, or .bag file of ROS 1.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Scenario to write; its map is beside it.")],
    odom: Annotated[
        str | None,
        typer.Option(metavar="TOPIC", help="Topic of the odometry, or /tf.", show_default="the only one, else /tf"),
    ] = None,
    scan: Annotated[
        str | None, typer.Option(metavar="TOPIC", help="Topic of the scans.", show_default="the only one")
    ] = None,
    mount: Annotated[
        str | None,
        typer.Option(metavar="X,Y,YAW", help="Where the lidar is on the robot.", show_default="as /tf_static says"),
    ] = None,
    resolution: Annotated[
        float | None,
        typer.Option(
            help="Side of a cell of the map, in metres. Default: 0.05, more where the map would be too large.",
            show_default=False,
        ),
    ] = None,
    radius: Annotated[float, typer.Option("--robot-radius", help="Radius of the robot, in metres.")] = 0.2,
    step_time: Annotated[float, typer.Option(help="Step time of the scenario, in seconds.")] = 0.1,
    start: Annotated[float, typer.Option("--start", help="Start of the window of time, in seconds.")] = 0.0,
    end: Annotated[float | None, typer.Option("--end", help="End of the window of time, in seconds.")] = None,
    range_max: Annotated[
        float | None,
        typer.Option(
            help="How far beams count, in metres.", show_default="hits: all; beams without one: 99 % of the hits"
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")] = False,
    json_output: Json = False,
) -> None:
    """Turn a bag into a scenario: its scans become the map, and the robot drives as its odometry or /tf says."""
    options = BagOptions(
        odom, scan, _mount(mount), resolution, radius, step_time, start, math.inf if end is None else end, range_max
    )
    before = existing(out)
    converted = convert(bag, out, options, overwrite=force)
    if json_output:
        typer.echo(json.dumps(asdict(converted)))
        return
    what = f"{converted.poses} poses, {converted.duration:.1f} s" + (
        f", a map of {converted.scans} scans" if converted.map else ""
    )
    show_written(converted.file, what, before=before)
    for note in converted.notes:
        console().print(f"note: {note}", style="yellow", soft_wrap=True)
    console().print(Text.assemble("run it: ", (f"irsim run {converted.file}", "cyan")), soft_wrap=True)


def _mount(text: str | None) -> tuple[float, float, float] | None:
    if text is None:
        return None
    try:
        x, y, yaw = (float(word) for word in text.split(","))
        if all(map(math.isfinite, (x, y, yaw))):
            return x, y, yaw
    except ValueError:
        pass
    raise InputError(f"--mount must be 3 numbers separated by commas, got {text[:40]!r}", "--mount 0.1,0,0")


def export_scene(
    scenario: Annotated[Path, typer.Argument(metavar="FILE", help="Scenario; it is not run.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="File to write: .usda, .usdc or .usdz.")],
    seed: Annotated[int, seed_option("Random seed, 0 or more. Default: 0.")] = 0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
) -> None:
    """Write the start of a scenario as a stage of OpenUSD. For a whole run, see `irsim export --to usd`."""
    before = existing(out)
    written = write(scenario, out, seed=seed, overwrite=force)
    size = written.stat().st_size / 1e3
    show_written(written, f"{size:.0f} kB", before=before)


bridge_app.command("doctor")(handle_errors(doctor))
bridge_app.command("preview")(handle_errors(bridge_splats.preview))
bridge_app.command("page")(handle_errors(bridge_splats.page))
bridge_app.command("import-bag")(handle_errors(import_bag))
bridge_app.command("import-pedestrians")(handle_errors(import_pedestrians))
bridge_app.command("compare-pedestrians")(handle_errors(compare_pedestrians))
bridge_app.command("pedestrians-suite")(handle_errors(pedestrians_suite))
bridge_app.command("export-scene")(handle_errors(export_scene))
