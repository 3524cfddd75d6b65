"""Path planners, under the names that IR-SIM scripts import; plain re-exports."""

from irsim.navigation.planners import RRT, AStarPlanner, InformedRRTStar, JPSPlanner, PRMPlanner, RRTStar

__all__ = ["RRT", "AStarPlanner", "InformedRRTStar", "JPSPlanner", "PRMPlanner", "RRTStar"]
