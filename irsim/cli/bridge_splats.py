"""``irsim bridge preview`` and ``irsim bridge page``: recorded runs among Gaussian splats."""

from __future__ import annotations

import json
from collections.abc import Collection
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

from irsim.bridges.export.cameras import PoseOptions
from irsim.bridges.export.registry import chosen_options
from irsim.bridges.splats.page import write_page
from irsim.bridges.splats.preview import PreviewOptions, write_preview
from irsim.cli.options import Json
from irsim.cli.output import console, existing, progress, show_written
from irsim.policies.converters.convert import parse_options

__all__ = ["page", "preview"]

Scene = Annotated[Path, typer.Argument(metavar="SCENE.ply", help="File of Gaussian splats.", show_default=False)]
RunName = Annotated[str, typer.Option("--run", metavar="RUN", help="Id or folder of a run, or 'last'.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Set KEY to VALUE, an option, such as height=1.2 or frame=habitat_yup. Repeatable.",
        show_default=False,
    ),
]


class Eye(str, Enum):
    """Where the eye of a preview is."""

    behind = "behind"
    robot = "robot"
    above = "above"


def preview(
    scene: Scene,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE", help="Picture (.png, .jpg, .webp) or film (.gif, .mp4 …).")
    ],
    run: RunName = "last",
    view: Annotated[Eye, typer.Option("--eye", help="Whether it is on the robot, behind it, or above.")] = Eye.behind,
    robot: Annotated[
        str | None, typer.Option(metavar="NAME", help="Default: the first one.", show_default=False)
    ] = None,
    step: Annotated[
        int | None, typer.Option(help="One picture of this step. Default: six of the run.", show_default=False)
    ] = None,
    options: Settings = None,
    json_output: Json = False,
) -> None:
    """Show a recorded run among Gaussian splats, as pictures or a film; no graphics card is needed.

    Options for --set: width, rows, fov, height, every, frame, sidecar, cut, fps. The scene is where the sidecar of the
    map says that was imported from it; frame=habitat_yup does without.
    """
    given = {"view": view.value, **parse_options(options or [])}
    before = existing(out)
    with progress("drawing") as report:
        chosen = chosen_options(PreviewOptions, given, "a preview")
        result = write_preview(scene, run, out, options=chosen, robot=robot, step=step, progress=report)
    first, last = result.steps
    what = "1 picture" if result.frames == 1 else f"{result.frames} pictures"
    _show(result.as_dict(), f"{what} of {result.splats:,} splats, steps {first} to {last}", json_output, before)


def page(
    scene: Scene,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="File to write, .html.")],
    run: RunName = "last",
    max_splats: Annotated[
        int, typer.Option(min=1, max=4_000_000, help="The least visible ones are left out above this number.")
    ] = 1_000_000,
    options: Settings = None,
    json_output: Json = False,
) -> None:
    """Write one HTML page with splats, paths and robots: turn it, play it, look from the robot.

    The page needs neither a network nor other files, and a browser with WebGL 2. Options for --set: height, every,
    frame, sidecar.
    """
    chosen = chosen_options(PoseOptions, parse_options(options or []), "a page")
    before = existing(out)
    result = write_page(scene, run, out, options=chosen, max_splats=max_splats)
    _show(result.as_dict(), f"{result.bytes / 1e6:.1f} MB: {result.splats:,} splats", json_output, before)


def _show(result: dict[str, Any], facts: str, json_output: bool, before: Collection[str]) -> None:
    if json_output:
        typer.echo(json.dumps(result, indent=2))
        return
    show_written(result["file"], facts, before=before)
    for note in result["notes"]:
        console().print(f"note: {note}", style="yellow", soft_wrap=True)
