"""``irsim bridge import-pedestrians``: recorded pedestrians of a data set become a scenario or a suite."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.text import Text

from irsim.bridges.pedestrians.importing import Placing
from irsim.bridges.pedestrians.importing import import_pedestrians as convert
from irsim.bridges.pedestrians.scenario import Layout
from irsim.bridges.pedestrians.suite import Episodes
from irsim.bridges.pedestrians.tracks import FORMATS, Window
from irsim.cli.options import Json, seed_option
from irsim.cli.output import console, existing, show_written
from irsim.common.text import plural
from irsim.diagnostics.errors import InputError

__all__ = ["import_pedestrians"]


def import_pedestrians(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="ETH's obsmat.txt, UCY's .vsp, or lines 'frame id x y' (TrajNet).")
    ],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", help="Scenario to write.", show_default=False)
    ] = None,
    suite: Annotated[
        Path | None,
        typer.Option(
            "--write-suite",
            metavar="FILE",
            show_default=False,
            help="Benchmark suite to write: windows of the recording are its scenarios.",
        ),
    ] = None,
    into: Annotated[
        Path | None,
        typer.Option(
            metavar="SCENE",
            show_default=False,
            help="Scene that gets the pedestrians; -o names another file for the result.",
        ),
    ] = None,
    offset: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Move the recording in the world.", show_default="0,0")
    ] = None,
    rotate: Annotated[
        float, typer.Option(help="Turn the recording about its origin, in degrees, before it is moved.")
    ] = 0.0,
    form: Annotated[
        str | None,
        typer.Option("--format", metavar="FORMAT", help="obsmat, vsp or trajnet.", show_default="as the file looks"),
    ] = None,
    fps: Annotated[
        float | None,
        typer.Option(help="Frames per second.", show_default="25 for .vsp, else such that rows are 0.4 s apart"),
    ] = None,
    start: Annotated[float, typer.Option("--start", help="Start of the window of time, in seconds.")] = 0.0,
    end: Annotated[float | None, typer.Option("--end", help="End of the window of time, in seconds.")] = None,
    crop: Annotated[str | None, typer.Option(metavar="X0,Y0,X1,Y1", help="Keep this area, in metres.")] = None,
    homography: Annotated[
        Path | None, typer.Option(metavar="FILE", help="3 x 3 matrix from pixels to metres, for .vsp.")
    ] = None,
    scale: Annotated[float | None, typer.Option(help="Metres of a pixel, instead of a homography.")] = None,
    image_size: Annotated[
        str | None,
        typer.Option(
            metavar="W,H", help="Size of the picture, if the homography counts pixels from the upper left corner."
        ),
    ] = None,
    robot_start: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Start of the robot.", show_default="left edge")
    ] = None,
    robot_goal: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Goal of the robot.", show_default="right edge")
    ] = None,
    behavior: Annotated[str | None, typer.Option(help="Behavior of the robot.", show_default="orca")] = None,
    robot: Annotated[bool, typer.Option("--add-robot/--no-robot", help="Add a robot.")] = True,
    step_time: Annotated[
        float | None, typer.Option(help="Step time of the scenario, in seconds.", show_default="0.1")
    ] = None,
    radius: Annotated[float, typer.Option(help="Radius of a pedestrian, in metres.")] = 0.25,
    margin: Annotated[
        float | None, typer.Option(help="Free border around all that is recorded, in metres.", show_default="1")
    ] = None,
    smooth: Annotated[bool, typer.Option("--smooth", help="Smooth curves between the recorded places.")] = False,
    windows: Annotated[int, typer.Option(help="Largest number of windows of the suite.")] = 10,
    length: Annotated[
        float | None,
        typer.Option(
            help="Length of a window of the suite, in seconds.",
            show_default="what the robot needs, with room to give way",
        ),
    ] = None,
    seed: Annotated[
        int,
        seed_option("Random seed, 0 or more: chooses the windows of the suite, if the recording has more. Default: 0."),
    ] = 0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")] = False,
    json_output: Json = False,
) -> None:
    """Turn recorded pedestrians into a scenario or a benchmark suite, in which each walks as it did, at its own times.

    With --into, a scene of yours gets the pedestrians; its world, robots, obstacles and comments stay.

    In the suite a robot crosses windows of the recording, from and to places that the seeds draw.

    Write into a checkout of your own only what the licence of the data allows; irsim ships none.
    """
    if form is not None and form not in FORMATS:
        raise InputError(f"{form!r} is not a format of pedestrians", f"choose {', '.join(FORMATS)}")
    box: Any = _numbers("--crop", crop, 4)
    size: Any = _numbers("--image-size", image_size, 2)
    begin: Any = _numbers("--robot-start", robot_start, 2)
    goal: Any = _numbers("--robot-goal", robot_goal, 2)
    moved: Any = _numbers("--offset", offset, 2)
    own = {"step_time": step_time, "margin": margin, "start": begin, "goal": goal, "behavior": behavior}
    given = {name: value for name, value in own.items() if value is not None}
    if into is not None and given:
        what = f"--into keeps the world and the robots of the scene, so {_option(next(iter(given)))} has no meaning"
        raise InputError(what, "leave it out, and change the scene")
    layout = Layout(
        file.name, radius=radius, interpolation="cubic" if smooth else "linear", robot=robot and into is None, **given
    )
    before = existing(out, suite)
    converted = convert(
        file,
        out,
        suite=suite,
        into=into,
        placing=Placing(rotate, moved or (0.0, 0.0)),
        form=form,
        fps=fps,
        window=Window(start, float("inf") if end is None else end, box),
        homography=homography,
        scale=scale,
        image_size=size,
        layout=layout,
        episodes=Episodes(windows, length, seed),
        overwrite=force,
    )
    if json_output:
        typer.echo(json.dumps(asdict(converted)))
        return
    if converted.file is not None:
        where = "" if converted.into is None else f" in {Path(converted.into).name}"
        people = plural(converted.pedestrians, "pedestrian")
        what = f"{people}{where}, {converted.rows} recorded places, {converted.duration:g} s"
        show_written(converted.file, what, before=before)
    if converted.suite is not None:
        what = f"{len(converted.windows)} windows of {converted.length:g} s, 10 seeds each"
        show_written(converted.suite, what, before=before)
    for note in converted.notes:
        console().print(f"note: {note}", style="yellow", soft_wrap=True)
    if converted.file is not None:
        console().print(Text.assemble("run it: ", (f"irsim run {converted.file}", "cyan")), soft_wrap=True)
    if converted.suite is not None:
        command = f"irsim benchmark {converted.suite} --policies orca,sfm"
        console().print(Text.assemble("run it: ", (command, "cyan")), soft_wrap=True)


def _option(name: str) -> str:
    """The option that gives a part of a layout."""
    return {"start": "--robot-start", "goal": "--robot-goal"}.get(name, f"--{name.replace('_', '-')}")


def _numbers(option: str, text: str | None, count: int) -> tuple[float, ...] | None:
    """Numbers separated by commas."""
    if text is None:
        return None
    try:
        values = tuple(float(word) for word in text.split(","))
    except ValueError:
        values = ()
    if len(values) != count or not all(map(math.isfinite, values)):
        raise InputError(f"{option} must be {count} numbers separated by commas, got {text[:40]!r}", f"{option} 0,0")
    return values
