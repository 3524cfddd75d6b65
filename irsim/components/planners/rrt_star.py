"""``rrt_star``: RRT that shortens its paths."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.planners._options import SamplingPlanner
from irsim.options.registry import PLANNERS
from irsim.options.units import Bool, Meters


class RrtStar(SamplingPlanner):
    """RRT that rewires the tree around each new point, so that paths get shorter."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rrt_star", "max_iter": 1000}]}

    name: Literal["rrt_star"] = "rrt_star"
    expand_dis: Annotated[Meters, Field(gt=0)] = 1.5
    """Longest extension of the tree."""
    connect_circle_dist: Annotated[Meters, Field(gt=0)] = 0.5
    """Scale of the radius in which the tree is rewired."""
    search_until_max_iter: Bool = False
    """Improve until all samples are drawn, instead of stopping at the first path."""


PLANNERS.register(RrtStar, kernel=core.RrtStarOptions)
