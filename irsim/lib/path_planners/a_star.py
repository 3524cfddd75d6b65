"""Plain re-export."""

from irsim.navigation.planners import AStarPlanner

__all__ = ["AStarPlanner"]
