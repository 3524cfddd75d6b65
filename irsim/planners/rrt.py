"""``rrt``: rapidly exploring random tree."""

from __future__ import annotations

from typing import Literal

from irsim.planners._options import SamplingPlanner
from irsim.registry import PLANNERS


class Rrt(SamplingPlanner):
    """Grow a tree of random extensions until it reaches the goal."""

    name: Literal["rrt"] = "rrt"


PLANNERS.register(Rrt)
