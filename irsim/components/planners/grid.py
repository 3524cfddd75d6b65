"""Planners on grids: A* and jump point search."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.components.options import GridPlanner
from irsim.options.registry import PLANNERS


class AStar(GridPlanner):
    """Shortest path over the eight neighbours of each cell (A*)."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "astar"}]}

    name: Literal["astar"] = "astar"


PLANNERS.register(AStar, kernel=core.AstarOptions)


class Jps(GridPlanner):
    """Jump point search: the paths of A*, found faster by skipping cells without a choice."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "jps"}]}

    name: Literal["jps"] = "jps"


PLANNERS.register(Jps, kernel=core.JpsOptions)
