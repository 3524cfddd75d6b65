"""Navigation metrics of a simulated episode; distances are between footprints, undefined values are NaN."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.metrics.definitions import EPISODE_METRICS, METRICS, Metric
    from irsim.metrics.episode import EpisodeMetrics, episode_metrics, robot_metrics
    from irsim.metrics.statistics import bootstrap, newcombe, spread, wilson
    from irsim.navigation.clearances import Approach, Clearance, approaches, clearance, closest, least

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
    "mcnemar",
    "newcombe",
    "robot_metrics",
    "spread",
    "wilson",
]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        **dict.fromkeys(("EPISODE_METRICS", "METRICS", "Metric"), "irsim.metrics.definitions"),
        **dict.fromkeys(
            ("Approach", "Clearance", "approaches", "clearance", "closest", "least"), "irsim.navigation.clearances"
        ),
        **dict.fromkeys(("EpisodeMetrics", "episode_metrics", "robot_metrics"), "irsim.metrics.episode"),
        **dict.fromkeys(("bootstrap", "mcnemar", "newcombe", "spread", "wilson"), "irsim.metrics.statistics"),
    },
)
