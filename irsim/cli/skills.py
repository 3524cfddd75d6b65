"""``irsim skills``: list the skills for coding agents, and install them."""

from __future__ import annotations

import json
from enum import Enum
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from rich.text import Text

from irsim.bundled import skills
from irsim.bundled.skills import find_skills
from irsim.cli.guard import FAILED, handle_errors
from irsim.cli.options import Json
from irsim.cli.output import console
from irsim.common.text import listed

if TYPE_CHECKING:
    from irsim.bundled.skills import Installed

__all__ = ["skills_app"]

skills_app = typer.Typer(name="skills", help="List and install the skills for coding agents.", no_args_is_help=True)

MAX_CHANGED_FILES = 5
"""Number of changed files that are listed by name."""


class Target(str, Enum):
    """Agent whose folder is used."""

    claude = "claude"
    agents = "agents"
    gemini = "gemini"
    cursor = "cursor"
    codex = "codex"


def list_(json_output: Json = False) -> None:
    """List the skills for coding agents that are included in irsim."""
    bundled = find_skills()
    if json_output:
        rows = [
            {
                "name": skill.name,
                "version": skill.version,
                "description": skill.description,
                "folder": str(skill.folder),
            }
            for skill in bundled
        ]
        typer.echo(json.dumps(rows, indent=2, ensure_ascii=False))
        return

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for skill in bundled:
        table.add_row(skill.name, skill.description.partition(". ")[0].rstrip(".") + ".")
    out = console()
    out.print(table)
    out.print(
        "\nirsim skills install --target claude (or agents, gemini, cursor, codex) installs them in this project."
    )


def install(
    target: Annotated[
        list[Target], typer.Option(help="Agent for which the skills are installed. Repeatable.", show_default=False)
    ],
    user: Annotated[
        bool, typer.Option("--user/--project", help="Install in the home directory, or in the current directory.")
    ] = False,
    skill: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Install only this skill. Repeatable.", show_default=False)
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite files that you have changed, and replace links.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only show what would be done.")] = False,
    json_output: Json = False,
) -> None:
    """Install the skills where a coding agent looks for them.

    Files that you have changed are kept, unless --force is given; the exit code is then 1.
    """
    chosen = skills.find_skills(skill or ())
    places = {skills.place_of(one.value, user=user): one.value for one in reversed(target)}
    done = [
        result for place in reversed(places) for result in skills.install(place, chosen, force=force, dry_run=dry_run)
    ]
    kept = [result for result in done if result.action == "kept"]
    if json_output:
        rows = [
            {
                "skill": result.name,
                "action": result.action,
                "version": result.version,
                "folder": str(result.folder),
                "written": result.written,
                "changed": result.changed,
            }
            for result in done
        ]
        typer.echo(json.dumps({"dry_run": dry_run, "skills": rows}, indent=2, ensure_ascii=False))
    else:
        _show(done, dry_run=dry_run)
    if kept:
        raise typer.Exit(FAILED)


def _show(done: list[Installed], *, dry_run: bool) -> None:
    out = console()
    if dry_run:
        out.print("nothing is written:")
    for result in done:
        style = {"kept": "yellow", "unchanged": "dim"}.get(result.action, "green")
        out.print(Text.assemble((f"{result.action:9}", style), f" {result.folder}"), soft_wrap=True)
        if result.changed:
            action = "kept; --force overwrites" if result.action == "kept" else "overwritten"
            out.print(
                f"          changed by you: {listed(result.changed, MAX_CHANGED_FILES)} ({action})", soft_wrap=True
            )


skills_app.command("list")(handle_errors(list_))
skills_app.command("install")(handle_errors(install))
