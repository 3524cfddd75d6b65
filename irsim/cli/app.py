"""The application: its commands in the order of ``irsim --help``."""

from __future__ import annotations

from typing import Annotated

import typer

from irsim.cli import (
    benchmark,
    convert,
    demo,
    describe,
    diff,
    diff_runs,
    export,
    export_policy,
    inspect,
    new,
    policies,
    render,
    replay,
    run,
    schema,
    suites,
    templates,
    train,
    validate,
)
from irsim.cli.bridge import bridge_app
from irsim.cli.guard import handle_errors
from irsim.cli.map import map_app
from irsim.cli.skills import skills_app

__all__ = ["app"]

app = typer.Typer(
    name="irsim",
    help="Simulate 2D robot navigation: scenarios are YAML files.",
    epilog="First steps: irsim demo, irsim new corridor-passing, irsim run corridor-passing.yaml",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(wanted: bool) -> None:
    if wanted:
        from irsim.common.version import version

        typer.echo(f"irsim {version()}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """Simulate 2D robot navigation: scenarios are YAML files."""


for _command in (
    demo.demo,
    templates.templates,
    new.new,
    validate.validate,
    diff.diff,
    run.run,
    inspect.inspect,
    diff_runs.diff_runs,
    replay.replay,
    export.export,
    benchmark.benchmark,
    suites.suites,
    policies.policies,
    train.train,
    export_policy.export_policy,
    convert.convert,
    render.render,
    describe.describe,
    schema.schema,
):
    app.command(_command.__name__.replace("_", "-"))(handle_errors(_command))
app.add_typer(map_app)
app.add_typer(bridge_app)
app.add_typer(skills_app)
