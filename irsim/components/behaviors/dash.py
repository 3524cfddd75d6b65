"""``dash``: straight to the goal."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.behaviors._options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Radians


class Dash(BehaviorOptions):
    """Drive straight to the goal at full speed, looking at nobody.

    `diff` drives at its top speed times the cosine of the heading error: slower while it turns, and backwards, or not
    at all if `vel_min` allows no reverse, while the goal is more than 90 degrees off. A car never slows down and
    circles a goal inside its turning circle, of radius wheelbase / tan(largest steering angle): raise `goal_threshold`.
    What stands in the way is driven into, so it ends in a collision and not in a time-out.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "dash"}, {"name": "dash", "loop": True}]}

    name: Literal["dash"] = "dash"
    angle_tolerance: Annotated[Radians, Field(ge=0)] = 0.1
    """Heading errors smaller than this are not corrected, so the path bends: some 0.2 m off the straight line on 12 m.
    Below largest turn rate x `step_time` / 2 the heading swings."""


BEHAVIORS.register(Dash, kernel=core.DashOptions)
