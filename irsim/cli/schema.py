"""``irsim schema``: write the JSON Schemas of scenarios, suites, tasks and networks, for editors."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from irsim.benchmarks.suite import SUITES
from irsim.cli.guard import FAILED
from irsim.cli.output import existing, show_written
from irsim.common import data_files as resources
from irsim.common.files import write_atomically
from irsim.diagnostics.errors import ScenarioError
from irsim.learning.tasks.files import TASKS
from irsim.policies.networks.document import policy_schema_text
from irsim.scenario.locate import locate
from irsim.scenario.model.json_schema import schema_text
from irsim.scenario.yaml.document import load_path
from irsim.scenario.yaml.modeline import schema_reference, with_modeline

__all__ = ["is_current", "schema"]


def schema(
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FILE",
            help="File to write; - prints the schema. Default: the schema file of the source checkout.",
        ),
    ] = None,
    check: Annotated[
        bool, typer.Option("--check", help="Write nothing; exit with code 1 if the file is out of date.")
    ] = False,
    kind: Annotated[
        Literal["scenario", "suite", "task", "policy"] | None,
        typer.Option("--of", help="Files that the schema describes. Default: all, and scenarios with -o."),
    ] = None,
    scenario: Annotated[
        Path | None,
        typer.Option(
            "--mark",
            metavar="FILE",
            help="Have editors read the schema of this installation for FILE, without a network, by its first line; "
            "`irsim new` writes the published address, which holds on any machine.",
        ),
    ] = None,
) -> None:
    """Write the JSON Schemas of scenarios, suites, tasks and networks, or connect a scenario file to its schema."""
    if scenario is not None:
        _connect(scenario)
        return

    makers = {
        "scenario": schema_text,
        "suite": SUITES.schema_text,
        "task": TASKS.schema_text,
        "policy": policy_schema_text,
    }
    if str(out) == "-" or (out is None and not check and resources.checkout() is None):
        typer.echo(makers[kind or "scenario"](), nl=False)
        return
    kinds = [kind] if kind is not None else ["scenario"] if out is not None else list(makers)
    stale = False
    for one in kinds:
        stale |= not is_current(out or resources.schema_file(one), makers[one](), check, "irsim schema")
    if stale:
        raise typer.Exit(FAILED)


def is_current(target: Path, text: str, check: bool, command: str) -> bool:
    """Write the file of a schema, or say whether it is up to date.

    Args:
        target: The file.
        text: The schema.
        check: Whether the file is compared rather than written.
        command: Command that writes it, for the message.
    """
    current = not check or (target.is_file() and target.read_text(encoding="utf-8") == text)
    if not current:
        typer.echo(f"{target} is out of date: run {command} to update it", err=True)
        return False
    if check:
        typer.echo(f"{target} is up to date")
    else:
        before = existing(target)
        write_atomically(target, text)
        show_written(target, before=before)
    return True


def _connect(scenario: Path) -> None:
    """Add the line for editors at the top of a scenario file."""
    document = load_path(locate(scenario))
    if document.text is None:
        raise ScenarioError(document.problems)
    target = Path(str(document.path))
    with target.open(encoding="utf-8", newline="") as file:
        before = file.read()
    after = with_modeline(before, target, installed=True)
    if after != before:
        write_atomically(target, after)
    typer.echo(f"{target}: editors find the schema at {schema_reference(target, installed=True)}")
