"""Metrics of proximity: Francis et al. (arXiv 2306.16740), CD, SC, DH, TTC; HuNavSim; CrowdNav; robot_sf."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irsim.metrics.motion import runs_of
from irsim.metrics.trajectory import Track

__all__ = ["NO_APPROACH", "proximity_metrics", "time_to_contact"]

NO_APPROACH = "no_approach"
"""Flag of a robot that was never on a collision course with a human, so that ``time_to_collision_min`` is NaN."""
_PERSONAL_M = 0.5
"""Distance [m] to a human below which a robot intrudes into its personal space."""
_ZONES = {"intimate": (-np.inf, 0.45), "personal": (0.45, 1.2), "social": (1.2, 3.6), "public": (3.6, np.inf)}
"""Proxemic zones: least and greatest distance [m] to the nearest human."""
_NEAR_M = 0.2
"""Distance [m] to a human below which there is discomfort, or a near miss."""


def proximity_metrics(track: Track) -> tuple[dict[str, float], list[str]]:
    """Metrics of the distances between footprints until a robot arrived, and its flags; NaN without such objects.

    - ``clearing_distance_min``, ``_avg`` [m]: to the nearest static object.
    - ``min_clearance`` [m]: to the nearest robot, human or static object.
    - ``distance_to_human_min``, ``_avg`` [m]: to the nearest human.
    - ``space_compliance``: share of rows with every human at 0.5 m or more (high is good);
      ``personal_space_intrusion_ratio`` is 1 minus it. ``proxemics_*_ratio``: share of rows with the nearest human
      closer than 0.45 m, to 1.2 m, to 3.6 m, and beyond.
    - ``discomfort_ratio``: share of rows with 0 < distance < 0.2 m, ``discomfort_min_dist`` the mean of those.
    - ``near_misses``: runs of rows within 0.2 m of a human that end without contact.
    - ``time_to_collision_min`` [s]: see :func:`time_to_contact`; NaN, and flagged, if the robot is never on a collision
      course with a human.
    """
    _, humans, static = track.distance.T
    nan = float("nan")
    metrics = {
        "min_clearance": _least(track.distance),
        "clearing_distance_min": _least(static),
        "clearing_distance_avg": _mean(static),
        "distance_to_human_min": _least(humans),
        "distance_to_human_avg": _mean(humans),
    }
    there = humans[~np.isnan(humans)]
    share = float((there >= _PERSONAL_M).mean()) if len(there) else nan
    metrics |= {"space_compliance": share, "personal_space_intrusion_ratio": 1.0 - share}
    for zone, (low, high) in _ZONES.items():
        metrics[f"proxemics_{zone}_ratio"] = float(((there >= low) & (there < high)).mean()) if len(there) else nan
    close = there[(there > 0) & (there < _NEAR_M)]
    metrics |= {
        "discomfort_ratio": len(close) / len(there) if len(there) else nan,
        "discomfort_min_dist": _mean(close),
        "near_misses": float(_near_misses(humans)) if len(there) else nan,
    }
    soonest = _least(time_to_contact(track))
    flags = [NO_APPROACH] if track.people and math.isnan(soonest) else []
    return metrics | {"time_to_collision_min": soonest}, flags


def time_to_contact(track: Track) -> NDArray[np.float64]:
    """(K - 1,) least time [s] until the bounding discs of the robot and a human touch at their present velocities.

    0 while they overlap; NaN if they never touch.
    """
    steps = len(track.pose) - 1
    best = np.full(max(steps, 0), np.nan)
    if steps < 1 or not len(track.reaches):
        return best
    apart = track.others[1:, :, :2] - track.position[1:, None]
    closing = np.diff(track.others[:, :, :2], axis=0) / track.step_time - track.velocity[:, None]
    reach = track.reaches + track.reach
    # |apart + closing t| = reach
    a, b = (closing**2).sum(axis=2), (apart * closing).sum(axis=2)
    c = (apart**2).sum(axis=2) - reach**2
    root = b**2 - a * c
    with np.errstate(invalid="ignore", divide="ignore"):
        times = np.where((root >= 0) & (b < 0), c / (-b + np.sqrt(np.maximum(root, 0))), np.inf)
    times = np.where(c <= 0, 0.0, times).min(axis=1)
    return np.asarray(np.where(np.isfinite(times), times, np.nan))


def _near_misses(distance: NDArray[np.float64]) -> int:
    """Number of runs of rows within the near-miss distance that end without a contact in them."""
    runs = runs_of(distance < _NEAR_M)
    return sum(bool((distance[begin:end] > 0).all()) and end < len(distance) for begin, end in runs)


def _least(values: NDArray[np.float64]) -> float:
    known = values[~np.isnan(values)]
    return float(known.min()) if len(known) else float("nan")


def _mean(values: NDArray[np.float64]) -> float:
    known = values[~np.isnan(values)]
    return float(known.mean()) if len(known) else float("nan")
