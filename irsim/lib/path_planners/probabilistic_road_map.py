"""Plain re-export."""

from irsim.navigation.planners import PRMPlanner

__all__ = ["PRMPlanner"]
