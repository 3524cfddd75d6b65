"""``rrt``: rapidly exploring random tree."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.components.planners._options import SamplingPlanner
from irsim.options.registry import PLANNERS


class Rrt(SamplingPlanner):
    """Grow a tree of random extensions until it reaches the goal."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rrt", "expand_dis": 1.0}]}

    name: Literal["rrt"] = "rrt"


PLANNERS.register(Rrt, kernel=core.RrtOptions)
