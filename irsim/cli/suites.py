"""``irsim suites``: list the bundled benchmarks."""

from __future__ import annotations

import json

import typer
from rich.table import Table

from irsim.benchmarks.suite import SUITES, WRITTEN_SUITES, load_suite
from irsim.benchmarks.suite_plan import suite_plan
from irsim.cli.options import Json
from irsim.cli.output import console

__all__ = ["suites"]


def suites(json_output: Json = False) -> None:
    """List the bundled suites: benchmarks with fixed scenarios, seeds, horizon, protocol and policies."""
    plans = {name: (load_suite(name)[0], suite_plan(name)) for name in SUITES.names()}
    if json_output:
        listed = [
            {
                "suite": suite.suite, "version": suite.version, "title": suite.title, "about": suite.about,
                "scenarios": [one.name for one in plan.scenarios], "policies": plan.policies,
                "others": suite.others,
                "protocols": suite.protocols, "seeds": len(plan.seeds), "steps": suite.steps, "seconds": suite.seconds,
            }
            for suite, plan in plans.values()
        ]  # fmt: skip
        typer.echo(json.dumps(listed, indent=2, ensure_ascii=False))
        return

    out = console()
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(style="bold cyan", no_wrap=True)
    table.add_column()
    for name, (suite, plan) in plans.items():
        size = f"{len(plan.scenarios)} scenarios x {len(plan.policies)} policies x {len(plan.seeds)} seeds"
        table.add_row(name, f"{suite.title} ({size})")
    out.print(table)
    for name, command in WRITTEN_SUITES.items():
        out.print(f"{name} is made of recordings that you have: {command}", soft_wrap=True)
    out.print("irsim benchmark NAME runs one; irsim describe NAME explains it")
