"""Metrics of navigation: what a recorded episode was worth.

Distances are between true footprints, never centres; what is undefined is NaN, never 0 or the horizon.
"""

from irsim.metrics.clearance import Approach, Clearance, approaches, clearance, closest, least
from irsim.metrics.definitions import EPISODE_METRICS, METRICS, Metric
from irsim.metrics.episode import EpisodeMetrics, episode_metrics, robot_metrics
from irsim.metrics.statistics import bootstrap, newcombe, spread, wilson

__all__ = [
    "EPISODE_METRICS",
    "METRICS",
    "Approach",
    "Clearance",
    "EpisodeMetrics",
    "Metric",
    "approaches",
    "bootstrap",
    "clearance",
    "closest",
    "episode_metrics",
    "least",
    "newcombe",
    "robot_metrics",
    "spread",
    "wilson",
]
