"""What every behavior's options have in common."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import ConfigDict

from irsim._options import Options
from irsim.units import Bool
from irsim.vectors import Pose

__all__ = ["BehaviorOptions", "CustomOptions"]


class BehaviorOptions(Options):
    """Keys that every behavior takes."""

    in_group: ClassVar[bool] = False
    """Whether it may be named under `group_behavior`: it decides for all members at once."""

    name: str
    """Which behavior."""
    wander: Bool = False
    """Start with, and after each arrival draw, a random goal between `range_low` and `range_high`."""
    loop: Bool = False
    """After the last goal start over; with one goal, shuttle between it and the start. `wander` wins over it."""
    range_low: Pose | None = None
    """Lower corner of random goals; null is the world's own. Two numbers leave the heading free."""
    range_high: Pose | None = None
    """Upper corner of random goals; null is the world's own. Two numbers leave the heading free."""
    target_roles: Literal["all", "robot", "obstacle"] = "all"
    """Which other objects the behavior is shown."""


class CustomOptions(BehaviorOptions):
    """A behavior registered by user code: its own keys reach the registered function as they are."""

    model_config = ConfigDict(extra="allow")
