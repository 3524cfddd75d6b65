"""``irsim skills``: what this package teaches coding agents, and putting it where they look."""

from __future__ import annotations

import json
from enum import Enum
from typing import TYPE_CHECKING, Annotated

import typer

from irsim.cli.guard import FAILED, guarded
from irsim.cli.options import Json
from irsim.common.text import listed

if TYPE_CHECKING:
    from irsim.bundled.skills import Installed

__all__ = ["skills_app"]

skills_app = typer.Typer(name="skills", help="Skills for coding agents: list them, install them.", no_args_is_help=True)


class Target(str, Enum):
    """Whose folder."""

    claude = "claude"
    agents = "agents"
    gemini = "gemini"
    cursor = "cursor"
    codex = "codex"


def list_(json_output: Json = False) -> None:
    """List the skills for coding agents that come with irsim."""
    from irsim.bundled.skills import find_skills

    found = find_skills()
    if json_output:
        rows = [
            {
                "name": skill.name,
                "version": skill.version,
                "description": skill.description,
                "folder": str(skill.folder),
            }
            for skill in found
        ]
        typer.echo(json.dumps(rows, indent=2, ensure_ascii=False))
        return
    from rich.table import Table

    from irsim.cli.output import console

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for skill in found:
        table.add_row(skill.name, skill.description.partition(". ")[0].rstrip(".") + ".")
    out = console()
    out.print(table)
    out.print("\nirsim skills install --target claude (or agents, gemini, cursor, codex) puts them into this project.")


def install(
    target: Annotated[list[Target], typer.Option(help="Host whose folder they go to. Repeatable.", show_default=False)],
    user: Annotated[
        bool, typer.Option("--user/--project", help="In the home directory, or below the current directory.")
    ] = False,
    skill: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Only this skill. Repeatable.", show_default=False)
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Overwrite files that were changed, and replace links.")
    ] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be done.")] = False,
    json_output: Json = False,
) -> None:
    """Put the skills where a coding agent looks for them. Exits with 1 if files changed by you were left alone."""
    from irsim.bundled import skills

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
    from rich.text import Text

    from irsim.cli.output import console

    out = console()
    if dry_run:
        out.print("nothing is written:")
    for result in done:
        style = {"kept": "yellow", "unchanged": "dim"}.get(result.action, "green")
        out.print(Text.assemble((f"{result.action:9}", style), f" {result.folder}"), soft_wrap=True)
        if result.changed:
            fate = "left alone; --force overwrites" if result.action == "kept" else "overwritten"
            out.print(f"          changed since: {listed(result.changed, 5)} ({fate})", soft_wrap=True)


skills_app.command("list")(guarded(list_))
skills_app.command("install")(guarded(install))
