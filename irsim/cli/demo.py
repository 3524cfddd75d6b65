"""``irsim demo``: simulate a bundled scenario and write an animation."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.text import Text

from irsim import api
from irsim.bundled import templates
from irsim.cli.options import Json, seed_option
from irsim.cli.output import console, existing, print_json, progress
from irsim.cli.run import show_result
from irsim.common.files import check_suffix
from irsim.graphics.encoding.picture_files import MOVING_SUFFIXES

__all__ = ["demo"]

_TEMPLATE = "crossing"
_SEED = 7


def demo(
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Animation file to write.")] = Path(
        "irsim-demo.gif"
    ),
    seed: Annotated[int, seed_option(f"Random seed, 0 or more. Default: {_SEED}.")] = _SEED,
    json_output: Json = False,
) -> None:
    """Simulate a bundled scenario and write an animation of it to the current directory."""
    before = existing(out)
    with progress("simulating and drawing") as report:
        check_suffix(out, MOVING_SUFFIXES)
        result = api.run(templates.scenario_file(_TEMPLATE), seed=seed, save=out, progress=report)
    if json_output:
        print_json(result)
        return
    shown = console()
    shown.print(templates.load(_TEMPLATE).purpose)
    show_result(result, shown, again=f"irsim demo --seed {seed}", before=before)
    shown.print(
        Text.assemble("next: ", (f"irsim new {_TEMPLATE} && irsim run {_TEMPLATE}.yaml", "cyan")), soft_wrap=True
    )
