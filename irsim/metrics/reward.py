"""Discounted rewards by which learned policies are compared: CrowdNav (Chen et al., ICRA 2019, arXiv 1809.08835)."""

from __future__ import annotations

import math

import numpy as np

from irsim.metrics.trajectory import Track
from irsim.simulation.roles import HUMAN

__all__ = ["crowdnav_reward", "reward_metrics"]

_ARRIVAL = 1.0
_COLLISION = -0.25
_DISCOMFORT_M = 0.2
"""Distance [m] to the nearest human below which a step costs something."""
_DISCOMFORT_COST = 0.5
"""Cost of a second at 1 m less than that distance [1/(m s)]."""
_DISCOUNT = 0.9
"""Factor by which a reward counts less for each metre that the robot could have travelled until then."""


def reward_metrics(track: Track) -> dict[str, float]:
    """Rewards of a robot until it arrived or collided.

    - ``crowdnav_reward``: see :func:`crowdnav_reward`.
    """
    return {"crowdnav_reward": crowdnav_reward(track)}


def crowdnav_reward(track: Track) -> float:
    """The discounted return of CrowdNav (Chen et al. 2019, section III, and the code published with it).

    A step earns 1 if the robot arrives in it, -0.25 if its first contact (with anything) begins in it, which then
    counts instead of an arrival, (d - 0.2 m) x 0.5 x dt if the nearest human is at 0 < d < 0.2 m at its end (surface to
    surface), else 0. The step that begins at time t counts 0.9^(t v_pref), where v_pref is the greatest speed limit.
    The sum ends at the arrival, the first contact, or the end of the trace.

    CrowdNav takes d as the smallest distance within the step, of straight paths; here it is that at the end of the
    step, as in all other metrics.

    Returns:
        The sum; 0 is a time-out that never came close to a human, 1 an immediate arrival. NaN if the speed is not
        limited.
    """
    if not math.isfinite(track.top_speed):
        return math.nan
    hit = min((event.step - track.first for event, _ in track.collisions), default=None)
    last = len(track.pose) - 1 if hit is None else hit
    humans = track.distance[1 : last + 1, HUMAN]
    near = (humans > 0) & (humans < _DISCOMFORT_M)
    reward = np.where(near, (humans - _DISCOMFORT_M) * _DISCOMFORT_COST * track.step_time, 0.0)
    begin = np.arange(len(reward)) * track.step_time
    end = _COLLISION if hit is not None else _ARRIVAL if track.arrival is not None else None
    if end is not None:
        reward, begin = np.append(reward[:-1], end), np.append(begin[:-1], max(last - 1, 0) * track.step_time)
    return float((reward * _DISCOUNT ** (begin * track.top_speed)).sum())
