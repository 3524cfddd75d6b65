"""``astar``: A* on a grid."""

from __future__ import annotations

from typing import Literal

from irsim.planners._options import GridPlanner
from irsim.registry import PLANNERS


class AStar(GridPlanner):
    """Shortest path over the eight neighbours of each cell (A*)."""

    name: Literal["astar"] = "astar"


PLANNERS.register(AStar)
