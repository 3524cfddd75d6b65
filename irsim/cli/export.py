"""``irsim export``: write recorded runs as files of other tools."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from irsim.bridges.export.episode import CHOICES
from irsim.bridges.export.export import export_run
from irsim.bridges.export.registry import format_names
from irsim.cli.guard import again, going_on
from irsim.cli.options import Json
from irsim.cli.output import console, existing, print_json, progress, show_written, size_text
from irsim.common.text import plural
from irsim.diagnostics.errors import InputError
from irsim.policies.converters.convert import parse_options
from irsim.runs.store import is_run

__all__ = ["export"]

_FORMATS = format_names()


def export(
    runs: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="RUN...",
            help="Id or folder of a run, or 'last', the default. Several runs go into one table or dataset.",
            show_default=False,
        ),
    ] = None,
    to: Annotated[
        str | None,
        typer.Option(
            metavar="FORMAT",
            help=f"Name of a format: {', '.join(_FORMATS[:-1])} or {_FORMATS[-1]}. Default: as the suffix of the file "
            "says.",
            show_default=False,
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="PATH",
            help="File to write; for some formats a new folder. Default: named after the run, in this directory.",
            show_default=False,
        ),
    ] = None,
    objects: Annotated[
        str | None,
        typer.Option(
            metavar="WHICH",
            help="movers (robots, and obstacles that can move), robots, people (obstacles that can move), all, or "
            "names separated by commas. Default: movers, but robots for cameras and people for isaac_people.",
            show_default=False,
        ),
    ] = None,
    ranges: Annotated[
        bool | None,
        typer.Option(
            "--ranges/--no-ranges", help="Write the ranges of lidars. Default: yes, but not to csv.", show_default=False
        ),
    ] = None,
    options: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Set KEY to VALUE, an option of the format, such as height=1.2 of cameras. Repeatable.",
            show_default=False,
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
    json_output: Json = False,
) -> None:
    """Write recorded runs for other programs: tables, ROS 2 bags, datasets, cameras, scenes of other simulators.

    Some formats need libraries, which extras install; without them the message says how.
    """
    chosen: str | list[str] | None = objects
    if objects is not None and objects not in CHOICES:
        chosen = [name.strip() for name in objects.split(",") if name.strip()]
    if (file := next((one for one in runs or () if Path(one).suffix and not is_run(one)), None)) is not None:
        raise InputError(f"{file!r} is not a recorded run", f"name the file to write with -o: -o {shlex.quote(file)}")
    before = existing(out)
    with going_on(lambda: f"nothing was written; again: {again()}"), progress("exporting") as report:
        result = export_run(
            runs or ["last"],
            out,
            to=to,
            objects=chosen,
            ranges=ranges,
            options=parse_options(options or []),
            overwrite=force,
            progress=report,
        )
    if json_output:
        print_json(result)
        return
    size = size_text(result.bytes)
    count = f"{len(result.run_ids)} runs, " if len(result.run_ids) > 1 else ""
    who = plural(len(result.objects), "object")
    show_written(result.file, f"{size}: {count}{who}, {result.steps} steps", before=before)
    for note in result.notes:
        console().print(f"note: {note}", style="yellow", soft_wrap=True)
