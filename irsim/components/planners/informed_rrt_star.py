"""``informed_rrt_star``: RRT* that samples where shorter paths can be."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.planners.rrt_star import RrtStar
from irsim.options.registry import PLANNERS
from irsim.options.units import Bool, Meters, Number


class InformedRrtStar(RrtStar):
    """RRT* that, once it has a path, samples only the ellipse that can hold a shorter one."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "informed_rrt_star"}]}

    name: Literal["informed_rrt_star"] = "informed_rrt_star"  # type: ignore[assignment]  # an rrt_star by another name
    goal_sample_rate: Annotated[Number, Field(ge=0, le=100)] = 10.0
    """Share of samples placed at the goal, in percent."""
    connect_circle_dist: Annotated[Meters, Field(gt=0)] = 50.0
    """Scale of the radius in which the tree is rewired."""
    search_until_max_iter: Bool = True
    """Improve until all samples are drawn, instead of stopping at the first path."""


PLANNERS.register(InformedRrtStar, kernel=core.InformedRrtStarOptions)
