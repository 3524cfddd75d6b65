"""The command ``irsim-evals``: its commands in the order of ``irsim-evals --help``."""

from __future__ import annotations

import typer

from irsim.cli.guard import handle_errors
from irsim.cli.output import prepare_streams
from irsim_evals.cli.cases import cases, export, schema
from irsim_evals.cli.check import check
from irsim_evals.cli.grade import grade
from irsim_evals.cli.language import predicates, properties, selections
from irsim_evals.cli.prove import prove
from irsim_evals.cli.report import compare, report
from irsim_evals.cli.run import run

__all__ = ["app", "main"]

app = typer.Typer(
    name="irsim-evals",
    help="Grade what agents make of prompts, and prove the grader right.",
    epilog="First steps: irsim-evals export trial, then irsim-evals grade trial",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for _command in (
    cases, export, grade, run, report, compare, check, prove, predicates, selections, properties, schema,
):  # fmt: skip
    app.command()(handle_errors(_command))


def main() -> None:
    """Run the command line."""
    prepare_streams()
    app()
