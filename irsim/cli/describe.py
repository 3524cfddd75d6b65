"""``irsim describe``: the language, its components, the templates and the codes, explained."""

from __future__ import annotations

from typing import Annotated

import typer

from irsim.cli.options import Json

__all__ = ["describe"]


def describe(
    topic: Annotated[
        list[str] | None,
        typer.Argument(help="Such as robot.sensors.lidar2d, behavior dash, a code, a template.", show_default=False),
    ] = None,
    json_output: Json = False,
) -> None:
    """Explain a part of the language, a component, a template or a code; without a topic: what there is."""
