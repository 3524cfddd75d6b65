"""What every path planner's options have in common."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Count, Meters, Number

__all__ = ["GridPlanner", "PlannerOptions", "SamplingPlanner"]


class PlannerOptions(Options):
    """A path planner on the map inflated by the footprint."""

    name: str
    """Which planner."""


class GridPlanner(PlannerOptions):
    """Plans on the cells of a grid."""

    resolution: Annotated[Meters, Field(gt=0)] | None = None
    """Cell size; null is the map's own, or 0.1 m without a map."""


class SamplingPlanner(PlannerOptions):
    """Plans on random samples, drawn from the environment's planner stream."""

    expand_dis: Annotated[Meters, Field(gt=0)] = 1.0
    """Longest extension of the tree."""
    path_resolution: Annotated[Meters, Field(gt=0)] = 0.25
    """Extensions end on multiples of this length; they are checked along their whole length."""
    goal_sample_rate: Annotated[Number, Field(ge=0, le=100)] = 5.0
    """Share of samples that are the goal, in percent."""
    max_iter: Count = 500
    """Samples drawn before giving up."""
