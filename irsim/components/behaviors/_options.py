"""Options that all behaviors have in common."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict

from irsim.options.base import Options
from irsim.options.units import Bool
from irsim.options.vectors import Pose

__all__ = ["BehaviorOptions", "CustomOptions", "behavior_fields"]


class BehaviorOptions(Options):
    """Keys that every behavior takes."""

    in_group: ClassVar[bool] = False
    """Whether it may be named under `group_behavior`: it decides for all members at once."""
    avoids: ClassVar[bool] = False
    """Whether it avoids other objects."""
    touches: ClassVar[bool] = False
    """Whether bodies that it moves touch others now and then."""
    stops_in_time: ClassVar[bool] = False
    """Whether it stops before what stands with any `timeHorizonObst`."""

    name: str
    """Name of the behavior."""
    wander: Bool = False
    """Drive to random goals between `range_low` and `range_high`; each object draws its next at each arrival."""
    loop: Bool = False
    """After the last goal, start again with the first; with one goal, shuttle between it and the start. `wander` takes
    precedence."""
    range_low: Pose | None = None
    """Lower corner of random goals, for the middle of the object; null is the world's own, where bodies at the edge
    reach beyond. Two numbers leave the heading free."""
    range_high: Pose | None = None
    """Upper corner of random goals, as `range_low`; null is the world's own."""
    target_roles: Literal["all", "robot", "obstacle"] = "all"
    """Role of the objects that it reacts to: with `robot` it does not avoid people who are obstacles, with `obstacle`
    no robots."""

    def draws(self) -> bool:
        """Whether its decisions draw random numbers, so that they depend on the seed."""
        return False


class CustomOptions(BehaviorOptions):
    """A behavior registered by user code: its own keys reach the registered function as they are."""

    model_config = ConfigDict(extra="allow")


def behavior_fields(options: Any, bounds: tuple[float, float, float, float]) -> dict[str, Any]:
    """The fields of an object that follow from the options of its behavior.

    Args:
        options: The options; None without a behavior.
        bounds: x0, y0, x1, y1 of the world [m], the default range of random goals.
    """
    x0, y0, x1, y1 = bounds
    low = getattr(options, "range_low", None) or [x0, y0]
    high = getattr(options, "range_high", None) or [x1, y1]
    return {
        "wander": getattr(options, "wander", False),
        "loop": getattr(options, "loop", False),
        "range_low": [*low, -math.pi][:3],
        "range_high": [*high, math.pi][:3],
        "target_roles": getattr(options, "target_roles", "all"),
    }
