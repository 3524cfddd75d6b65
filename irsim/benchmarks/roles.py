"""Metrics by role, where several policies share the robots of a world: each selection of robots on its own."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from irsim.metrics.episode import EpisodeMetrics
from irsim.policies.mixed import MixedPolicy
from irsim.policies.parts import robots_of_parts
from irsim.policies.policy import Policy
from irsim.scenario.resolve.resolved import ObjectRecord

__all__ = ["COMPARED", "role_metrics", "shared_with"]

COMPARED = "compared"
"""Stands for the policy that is compared among the policies of a scenario's robots."""


def shared_with(policy: Policy, parts: Mapping[str, Policy | None]) -> Policy:
    """The policy of a scenario whose robots are shared between a compared policy and others.

    Args:
        policy: The compared policy.
        parts: Name or tag of robots -> the policy that drives them, None for the compared one; empty: it drives all.
    """
    return MixedPolicy({key: one or policy for key, one in parts.items()}) if parts else policy


def role_metrics(
    policy: Policy | None,
    records: Sequence[ObjectRecord],
    measured: EpisodeMetrics,
    hits: Collection[str],
    limit: float,
) -> dict[str, dict[str, float]]:
    """Metrics of the robots of each part of a policy of several, in one episode.

    Args:
        policy: The policy that drove the episode.
        records: The objects of the scenario.
        measured: The metrics of all its robots.
        hits: Names of robots whose collision ended the episode.
        limit: The horizon [s].

    Returns:
        By selection: ``robots`` (their number), ``success``, ``collision`` and ``timeout`` (shares of them), and means:
        ``time_to_goal`` [s] and ``velocity_avg`` [m/s] of robots that arrived (NaN without any), ``restricted_time``
        [s], which counts the horizon for the others, and ``collision_count``. Empty for other policies.
    """
    if policy is None or not policy.parts:
        return {}
    robots = dict(zip(measured.names, measured.robots, strict=True))
    roles = {}
    for key, names in robots_of_parts(policy, records).items():
        mine = [(name, robots[name]) for name in names if name in robots]
        success = [float(bool(one["success"]) and name not in hits) for name, one in mine]
        late = [float(bool(one["timeout"]) and name not in hits) for name, one in mine]
        times = [one["time_to_goal"] for _, one in mine]
        values = {
            "success": success,
            "collision": [1.0 - done - open_ for done, open_ in zip(success, late, strict=True)],
            "timeout": late,
            "time_to_goal": [time for time in times if not math.isnan(time)],
            "velocity_avg": [one["velocity_avg"] for _, one in mine if not math.isnan(one["time_to_goal"])],
            "restricted_time": [limit if math.isnan(time) else time for time in times],
            "collision_count": [one["collision_count"] for _, one in mine],
        }
        means = {name: math.fsum(some) / len(some) if some else math.nan for name, some in values.items()}
        roles[key] = {"robots": float(len(mine)), **means}
    return roles
