"""``irsim render``: draw a picture or an animation of a scenario."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.text import Text

from irsim import api
from irsim.api.overlays import OVERLAYS
from irsim.api.render_run import render_run
from irsim.cli.findings import import_user_modules, limits_for, print_warnings
from irsim.cli.options import File, Imports, Json, MaxObjects, Seed, Strict
from irsim.cli.output import console, existing, print_json, progress, show_written
from irsim.common.files import check_suffix
from irsim.diagnostics.errors import InputError
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES, PICTURE_FORMATS
from irsim.results.picture import view_message
from irsim.runs.store import is_run
from irsim.validation.scene_text import scene_lines

__all__ = ["render"]


def render(
    file: File,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="OUT", help="File to write: .png, .svg, .pdf, or .gif, .mp4, .apng.")
    ],
    policy: Annotated[
        str | None,
        typer.Option(
            "--policy", help="Policy of every robot instead: a behavior, a policy, or a file (irsim policies)."
        ),
    ] = None,
    seed: Seed = None,
    step: Annotated[
        int | None,
        typer.Option(
            "--step",
            min=0,
            metavar="N",
            help="Step to draw: a picture shows the state after N steps (default: 0, the start), an animation ends "
            "there.",
            show_default=False,
        ),
    ] = None,
    size: Annotated[int | None, typer.Option(min=64, max=8192, help="Longer side of the picture in pixels.")] = None,
    region: Annotated[
        tuple[float, float, float, float] | None,
        typer.Option(metavar="X_MIN Y_MIN X_MAX Y_MAX", help="Part of the world to show, in metres."),
    ] = None,
    strip: Annotated[
        int | None,
        typer.Option(
            min=2,
            max=12,
            metavar="N",
            help="Show N moments in one picture, from the start to --step (default: to the end of the episode).",
        ),
    ] = None,
    overlays: Annotated[
        str | None,
        typer.Option(metavar="NAME,NAME", help=f"Draw only these besides the bodies (png): {', '.join(OVERLAYS)}."),
    ] = None,
    style: Annotated[
        str | None, typer.Option(metavar="STYLE", help="Style: modern, or classic as in IR-SIM 2.12.")
    ] = None,
    theme: Annotated[str | None, typer.Option(metavar="THEME", help="Colours: light or dark (modern).")] = None,
    printed: Annotated[bool, typer.Option("--print", help="For print: 8 cm wide, 300 dpi, on white (modern).")] = False,
    verbose: Annotated[
        bool, typer.Option("-v", "--verbose", help="Also print a table of the objects: drives, footprints, places.")
    ] = False,
    json_output: Json = False,
    strict: Strict = False,
    imports: Imports = None,
    max_objects: MaxObjects = None,
) -> None:
    """Draw a scenario, or a recorded run (its id, its folder or `last`), as a picture or an animation.

    The suffix of the file decides which. A run is drawn as it was recorded, with what a policy or a bridge did in it;
    a picture without `--step` shows its end.

    `--verbose` and `--json` add a table of its objects: drives, footprints, places, and the ranges of what is random.
    """
    import_user_modules(imports)
    before = existing(out)
    with progress("drawing") as report:
        check_suffix(out, [*PICTURE_FORMATS, *MOVING_SUFFIXES])
        shown_as: dict[str, Any] = {
            "steps": step, "size": size, "region": region, "strip": strip, "progress": report,
            "style": style, "theme": theme, "printed": printed,
            "overlays": None if overlays is None else overlays.split(","), "limits": limits_for(max_objects),
        }  # fmt: skip
        if is_run(file):
            given = {"--policy": policy, "--seed": seed, "--strict": strict, "--import": imports}
            if extra := [name for name, value in given.items() if value]:
                what = f"{', '.join(extra)} cannot change the recorded run {str(file)!r}"
                raise InputError(what, f"leave out {extra[0]}, or name the scenario")
            result = render_run(file, out, **shown_as)
        else:
            result = api.render(file, out, policy=policy, seed=seed, strict=strict, imports=imports or (), **shown_as)
    if json_output:
        print_json(result)
        return
    print_warnings(result.warnings, file)
    shown = console()
    frames = f", {result.frames} frames" if result.frames > 1 else ""
    width, height = result.size
    for written in result.files:
        show_written(written, f"{width} x {height} px{frames}, step {result.steps}", before=before)
    if result.ended is not None:
        shown.print(f"step {result.steps} is beyond the end of the episode, which is step {result.ended}")
    if result.view is not None:
        left, right, low, top = result.extent
        whole = f"--region {left:g} {low:g} {right:g} {top:g} shows the world"
        shown.print(f"note: the picture {view_message(result.view)}: {whole}", style="yellow", soft_wrap=True)
    for line in [] if not verbose else scene_lines(result.table.model_dump(), result.labels, result.seed):
        shown.print(Text(line), soft_wrap=True)
    shown.print(Text.assemble("reproduce: ", (result.reproduce, "cyan")), soft_wrap=True)
