"""Plain re-export."""

from irsim.navigation.planners import JPSPlanner

__all__ = ["JPSPlanner"]
