"""Plain re-export."""

from irsim.navigation.planners import RRTStar

__all__ = ["RRTStar"]
