"""``dash``: straight to the goal."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import BehaviorOptions
from irsim.options.registry import BEHAVIORS
from irsim.options.units import Radians


class Dash(BehaviorOptions):
    """Drive straight to the goal at full speed, without avoiding anything.

    `diff` drives at its top speed times the cosine of the heading error: slower while it turns and, while the goal is
    more than 90 degrees off, backwards, or not at all if `vel_min` allows no reverse. A car never slows down, and it
    circles a goal inside its turning circle, of radius wheelbase / tan(largest steering angle): raise `goal_threshold`.
    A blocked path ends in a collision, not in a time-out. It does not brake for its goal: with `acce` it rolls on past
    it (0.4 m at 1 m/s and 1 m/s²) and comes back.
    """

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "dash"}, {"name": "dash", "loop": True}]}

    name: Literal["dash"] = "dash"
    angle_tolerance: Annotated[Radians, Field(ge=0)] = 0.1
    """Heading errors smaller than this are not corrected, so the path deviates by about 0.2 m on 12 m. If it is below
    largest turn rate x `step_time` / 2, the heading oscillates."""


BEHAVIORS.register(Dash, kernel=core.DashOptions)
