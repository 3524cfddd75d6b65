"""``ease``: straight to the goal, and slower the nearer the goal is."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Meters


class Ease(BehaviorOptions):
    """Drive straight to the goal and slow down near it, without avoiding anything."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "ease"}, {"name": "ease", "slow_radius": 2.0}]}

    name: Literal["ease"] = "ease"
    slow_radius: Annotated[Meters, Field(gt=0)] = 1.0
    """Distance to the goal below which the speed is proportional to the remaining distance."""


BEHAVIORS.register(Ease, kernel=core.EaseOptions)
