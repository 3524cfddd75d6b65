"""Metrics of navigation: what a recorded episode was worth.

Distances are between true footprints, never centres; what is undefined is NaN, never 0 or the horizon.
"""

from irsim.metrics.clearance import Approach, Clearance, clearance, closest

__all__ = ["Approach", "Clearance", "clearance", "closest"]
