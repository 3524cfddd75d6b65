"""``irsim bridge import-bag``: a recording of a robot becomes a scenario that replays it."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from irsim.bridges.ros.bags.importing import BagOptions
from irsim.bridges.ros.bags.importing import import_bag as convert
from irsim.cli.options import Json
from irsim.cli.output import console
from irsim.diagnostics.errors import InputError

__all__ = ["import_bag"]


def import_bag(
    bag: Annotated[Path, typer.Argument(metavar="BAG", help="Folder of rosbag2, or .bag file of ROS 1.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Scenario to write; its map is beside it.")],
    odom: Annotated[
        str | None, typer.Option(metavar="TOPIC", help="Topic of the odometry.", show_default="the only one")
    ] = None,
    scan: Annotated[
        str | None, typer.Option(metavar="TOPIC", help="Topic of the scans.", show_default="the only one")
    ] = None,
    mount: Annotated[
        str | None,
        typer.Option(metavar="X,Y,YAW", help="Where the lidar is on the robot.", show_default="as /tf_static says"),
    ] = None,
    resolution: Annotated[float, typer.Option(help="Side of a cell of the map, in metres.")] = 0.05,
    radius: Annotated[float, typer.Option(help="Radius of the robot, in metres.")] = 0.2,
    step_time: Annotated[float, typer.Option(help="Step time of the scenario, in seconds.")] = 0.1,
    start: Annotated[float, typer.Option("--from", help="Start of the window of time, in seconds.")] = 0.0,
    end: Annotated[float | None, typer.Option("--to", help="End of the window of time, in seconds.")] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")] = False,
    json_output: Json = False,
) -> None:
    """Turn a bag into a scenario: its scans become the map, and the robot drives as its odometry says."""
    options = BagOptions(
        odom, scan, _mount(mount), resolution, radius, step_time, start, math.inf if end is None else end
    )  # fmt: skip
    found = convert(bag, out, options, overwrite=force)
    if json_output:
        typer.echo(json.dumps(asdict(found)))
        return
    what = f": {found.poses} poses, {found.duration:.1f} s" + (f", a map of {found.scans} scans" if found.map else "")
    console().print(Text.assemble("wrote ", (found.file, "bold"), what), soft_wrap=True)
    for note in found.notes:
        console().print(f"note: {note}", style="yellow", soft_wrap=True)
    console().print(Text.assemble("run it: ", (f"irsim run {found.file}", "cyan")), soft_wrap=True)


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
