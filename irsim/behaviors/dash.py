"""``dash``: straight to the goal."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim import _core as core
from irsim.behaviors._options import BehaviorOptions
from irsim.registry import BEHAVIORS
from irsim.units import Radians


class Dash(BehaviorOptions):
    """Drive straight to the goal at full speed, looking at nobody."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "dash"}, {"name": "dash", "loop": True}]}

    name: Literal["dash"] = "dash"
    angle_tolerance: Annotated[Radians, Field(ge=0)] = 0.1
    """Heading errors smaller than this are not corrected."""


BEHAVIORS.register(Dash, kernel=core.DashOptions)
