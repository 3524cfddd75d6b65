"""``irsim bridge export-scene``: the start of a scenario that need not be run, as a file of another program."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from irsim.bridges.usd.files import export_scene as write
from irsim.cli.output import console

__all__ = ["export_scene"]


def export_scene(
    scenario: Annotated[Path, typer.Argument(metavar="FILE", help="Scenario; it is not run.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="File to write: .usda, .usdc or .usdz.")],
    seed: Annotated[int, typer.Option(min=0, help="Seed of what is drawn at random.")] = 0,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the file if it exists.")] = False,
) -> None:
    """Write the start of a scenario as a stage of OpenUSD. For a whole run, see `irsim export --to usd`."""
    written = write(scenario, out, seed=seed, overwrite=force)
    size = written.stat().st_size / 1e3
    console().print(Text.assemble("wrote ", (str(written), "bold"), f" ({size:.0f} kB)"), soft_wrap=True)
