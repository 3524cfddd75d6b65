"""Plain re-export."""

from irsim.navigation.planners import RRT

__all__ = ["RRT"]
