"""``irsim replay``: write a recorded run as a page for the browser."""

from __future__ import annotations

import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from irsim.cli.options import Json
from irsim.cli.output import console, existing, print_json, progress, show_written, size_text
from irsim.runs.reading import open_run
from irsim.runs.replay.export import replay as write

__all__ = ["replay"]


def replay(
    run: Annotated[str, typer.Argument(help="Id or folder of a run, or 'last'.")] = "last",
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE",
            help="File to write, .html. Default: RUN.html in the current directory.",
            show_default=False,
        ),
    ] = None,
    show: Annotated[bool, typer.Option("--open", help="Also open the page in the browser.")] = False,
    json_output: Json = False,
) -> None:
    """Write a recorded run as one HTML page: play it, scrub, follow a robot, jump to events.

    The page needs neither network nor other files. `irsim run FILE --record` records a run.
    """
    opened = open_run(run)
    target = out or Path(f"{opened.id}.html")
    before = existing(target)
    with progress("packing"):
        result = write(opened, target)
    if show:
        webbrowser.open(Path(result.file).resolve().as_uri())
    if json_output:
        print_json(result)
        return
    thinned = f", every {result.every} steps" if result.every > 1 else ""
    size = size_text(result.bytes)
    show_written(result.file, f"{size}, steps 0 to {result.last_step}{thinned}", before=before)
    for note in result.notes:
        console().print(f"note: {note}", style="yellow")
