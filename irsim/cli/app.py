"""The application: its commands in the order of ``irsim --help``, each loaded when it is used.

The first sentence of a command's docstring is its help, and what ``irsim --help`` says of it. Exit codes are 0
(finished), 1 (could not finish) and 2 (invalid input).
"""

from __future__ import annotations

import shlex
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from irsim.cli.guard import INTERRUPTED, again, handle_errors, say_interrupted
from irsim.cli.names import finished
from irsim.cli.sentences import SENTENCES
from irsim.common.installed import version
from irsim.common.text import clean

__all__ = ["COMMANDS", "FILES_RULE", "app", "loaded"]

COMMANDS = {
    "demo": "demo:demo",
    "templates": "templates:templates",
    "new": "new:new",
    "studio": "studio:studio",
    "validate": "validate:validate",
    "diff": "diff:diff",
    "run": "run:run",
    "inspect": "inspect:inspect",
    "diff-runs": "diff_runs:diff_runs",
    "audit": "audit:audit",
    "replay": "replay:replay",
    "export": "export:export",
    "benchmark": "benchmark:benchmark",
    "suites": "suites:suites",
    "policies": "policies:policies",
    "train": "train:train",
    "export-policy": "convert:export_policy",
    "convert": "convert:convert",
    "render": "render:render",
    "describe": "describe:describe",
    "schema": "schema:schema",
    "map": "map:map_app",
    "bridge": "bridge:bridge_app",
    "skills": "skills:skills_app",
}
"""Name of a command or of a group of commands -> module and name of what does it."""
FILES_RULE = (
    "Files that exist: pictures, films, HTML pages and schemas are made again, and the line then says 'replaced'. All "
    "others, such as scenarios, maps, tables and policies, stay as they are unless --force is given."
)
"""How all commands treat a file that they are to write and that exists already."""
PANELS = {
    "Start": ("demo", "templates", "new", "studio"),
    "Scenarios": ("validate", "diff", "render", "describe", "schema"),
    "Runs": ("run", "inspect", "diff-runs", "audit", "replay", "export"),
    "Comparisons": ("benchmark", "suites", "policies"),
    "Learning": ("train", "export-policy", "convert"),
    "Other programs": ("map", "bridge", "skills"),
}
"""Groups of commands in the help."""
TOOLS = {
    "lookup": "describe",
    "validate_scenario": "validate",
    "render_snapshot": "render",
    "run_episode": "run",
    "inspect_run": "inspect",
    "export_run": "export",
    "write_scenario": "new",
}
"""Name of a tool of the MCP server, for which an agent may look among the commands -> the command that does it."""


def loaded(name: str) -> Any:
    """Import a command: a function, or the application of a group."""
    module, _, attribute = COMMANDS[name].partition(":")
    return getattr(import_module(f"irsim.cli.{module}"), attribute)


class Commands(TyperGroup):
    """A group that imports a command when it is used; its help shows their first sentences without importing any."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._listing = False
        for panel, names in PANELS.items():
            for name in names:
                self.commands[name] = TyperCommand(
                    name, callback=lambda: None, help=SENTENCES[name], rich_markup_mode="rich", rich_help_panel=panel
                )

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Return a command; in a list of commands only its name and sentence."""
        if self._listing or cmd_name not in COMMANDS:
            return super().get_command(ctx, cmd_name)
        target = loaded(cmd_name)
        if not isinstance(target, typer.Typer):
            one = typer.Typer(add_completion=False, rich_markup_mode="rich")
            one.command(cmd_name)(handle_errors(target))
            target = one
        command = typer.main.get_command(target)
        command.name = cmd_name
        return finished(command, cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command of some words; the name of a tool of the MCP server is answered with its command."""
        if args and (meant := TOOLS.get(args[0])):
            words = shlex.join(["irsim", meant, *(clean(word, 60) for word in args[1:])])
            ctx.fail(f"{args[0]!r} is a tool of irsim-mcp. The command is: {words}")
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: Any) -> Any:
        """Run a command; Ctrl-C while it is imported ends it as later."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            say_interrupted(f"again: {again()}")
            raise typer.Exit(INTERRUPTED) from None

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help."""
        self._listing = True
        try:
            super().format_help(ctx, formatter)
        finally:
            self._listing = False

    def shell_complete(self, ctx: Any, incomplete: str) -> list[Any]:
        """Return completions of the name of a command."""
        self._listing = True
        try:
            return super().shell_complete(ctx, incomplete)
        finally:
            self._listing = False


app = typer.Typer(
    name="irsim",
    cls=Commands,
    help="Simulate 2D robot navigation: scenarios are YAML files.",
    epilog=f"First steps: irsim demo, irsim new corridor-passing, irsim run corridor-passing.yaml\n\n{FILES_RULE}",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"irsim {version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Simulate 2D robot navigation: scenarios are YAML files."""
