"""Path planning: maps, and the planners as classes; the searches themselves are computed by the core.

Names are imported when first used, because planning needs the core and NumPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.navigation.map import EnvGridMap, Map
    from irsim.navigation.planners import (
        RRT,
        AStarPlanner,
        InformedRRTStar,
        JPSPlanner,
        PathNode,
        PathPlanner,
        PRMPlanner,
        RRTStar,
    )

__all__ = [
    "RRT",
    "AStarPlanner",
    "EnvGridMap",
    "InformedRRTStar",
    "JPSPlanner",
    "Map",
    "PRMPlanner",
    "PathNode",
    "PathPlanner",
    "RRTStar",
]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "AStarPlanner": "irsim.navigation.planners",
        "EnvGridMap": "irsim.navigation.map",
        "InformedRRTStar": "irsim.navigation.planners",
        "JPSPlanner": "irsim.navigation.planners",
        "Map": "irsim.navigation.map",
        "PRMPlanner": "irsim.navigation.planners",
        "PathNode": "irsim.navigation.planners",
        "PathPlanner": "irsim.navigation.planners",
        "RRT": "irsim.navigation.planners",
        "RRTStar": "irsim.navigation.planners",
    },
)
