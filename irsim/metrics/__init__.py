"""Metrics of navigation: what a recorded episode was worth.

Distances are between true footprints, never centres; what is undefined is NaN, never 0 or the horizon.
"""

from irsim.metrics.clearance import Approach, Clearance, clearance, closest
from irsim.metrics.definitions import METRICS, Metric
from irsim.metrics.episode import EpisodeMetrics, episode_metrics, robot_metrics
from irsim.metrics.statistics import bootstrap, spread, wilson

__all__ = [
    "METRICS",
    "Approach",
    "Clearance",
    "EpisodeMetrics",
    "Metric",
    "bootstrap",
    "clearance",
    "closest",
    "episode_metrics",
    "robot_metrics",
    "spread",
    "wilson",
]
