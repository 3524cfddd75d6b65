"""``irsim templates``: list the bundled scenarios to start from."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Literal

import typer
from rich.table import Table

from irsim.api.take_snapshot import snapshot
from irsim.bundled.templates import find, scenario_file
from irsim.cli.options import Json
from irsim.cli.output import console, existing, show_written
from irsim.common.files import check_suffix
from irsim.graphics.encoding.contact_sheet import contact_sheet

__all__ = ["templates"]

_SHEET_STEPS = 50
_OVERLAYS: tuple[Literal["goals", "paths", "sensors"], ...] = ("goals", "paths", "sensors")


def templates(
    words: Annotated[
        list[str] | None, typer.Argument(help="List only templates that match these words.", show_default=False)
    ] = None,
    sheet: Annotated[
        Path | None,
        typer.Option(help="Draw the templates, each some seconds after its start, in one picture.", show_default=False),
    ] = None,
    json_output: Json = False,
) -> None:
    """List the bundled scenarios to start from."""
    if sheet is not None:
        check_suffix(sheet, (".png", ".jpg", ".webp"))
    matching = find(words or ())
    if sheet is not None:
        steps = [(template.name, scenario_file(template.name)) for template in matching]
        pictures = ((name, snapshot(path, seed=1, steps=_SHEET_STEPS, overlays=_OVERLAYS).png) for name, path in steps)
        before = existing(sheet)
        show_written(contact_sheet(pictures, sheet), before=before, stderr=json_output)
        if not json_output:
            return
    if json_output:
        listed = [template.model_dump(mode="json", exclude={"text", "sets"}) for template in matching]
        typer.echo(json.dumps(listed, indent=2, ensure_ascii=False))
        return

    out = console()
    if not matching:
        out.print(f"no template matches {' '.join(words or ())!r}; irsim templates lists all")
        return
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for template in matching:
        table.add_row(template.name, template.purpose)
    out.print(table)
    out.print("\nirsim describe NAME shows the parameters; irsim new NAME writes the scenario file.")
