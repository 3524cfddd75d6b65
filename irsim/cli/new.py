"""``irsim new``: write a scenario file from a template."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from irsim import api
from irsim.bundled import templates
from irsim.cli.findings import print_findings
from irsim.cli.guard import INVALID
from irsim.cli.output import console, existing, show_written
from irsim.common.files import write_new
from irsim.scenario.yaml.modeline import with_modeline

__all__ = ["new"]


def new(
    name: Annotated[str, typer.Argument(help="Name of a template; `irsim templates` lists them.", show_default=False)],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", help="File to write; - prints it. Default: NAME.yaml.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Set KEY to VALUE, a parameter of the template, such as width=1.6. Repeatable.",
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file.")] = False,
) -> None:
    """Write a new scenario from a template and its parameters.

    `irsim describe NAME` shows the parameters of a template.
    """
    template = templates.load(name)
    given = templates.parse_settings(settings or ())
    text = templates.fill(template, given)
    report = api.validate(text=text)
    print_findings(report.findings, str(out or name), text=text, stderr=True)
    if not report.valid:
        raise typer.Exit(INVALID)
    if str(out) == "-":
        typer.echo(text, nl=False)
        return
    target = out or Path(f"{name}.yaml")
    before = existing(target)
    write_new(target, with_modeline(text, target), overwrite=force)
    shown = console()
    show_written(target, before=before)
    shown.print(f"{template.purpose} {template.prospect(given)}")
    shown.print(Text.assemble("next: ", (shlex.join(["irsim", "run", str(target)]), "cyan")), soft_wrap=True)
