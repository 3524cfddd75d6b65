"""Options that path planners have in common."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Count, Meters, Number

__all__ = ["GridPlanner", "PlannerOptions", "SamplingPlanner"]


class PlannerOptions(Options):
    """Plan a path on the map inflated by the footprint."""

    name: str
    """Name of the planner."""


class GridPlanner(PlannerOptions):
    """Plans on the cells of a grid."""

    resolution: Annotated[Meters, Field(gt=0)] | None = None
    """Cell size of the grid; null is the map's (`follow`: above 2,500 m^2), else 0.1 m."""


class SamplingPlanner(PlannerOptions):
    """Plans with random samples, drawn from the planner stream of the environment."""

    expand_dis: Annotated[Meters, Field(gt=0)] = 1.0
    """Longest extension of the tree."""
    path_resolution: Annotated[Meters, Field(gt=0)] = 0.25
    """Extensions end at multiples of this length; collisions are checked all along."""
    goal_sample_rate: Annotated[Number, Field(ge=0, le=100)] = 5.0
    """Share of samples placed at the goal, in percent."""
    max_iter: Count = 500
    """Largest number of samples."""
