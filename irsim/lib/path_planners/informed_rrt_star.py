"""Plain re-export."""

from irsim.navigation.planners import InformedRRTStar

__all__ = ["InformedRRTStar"]
