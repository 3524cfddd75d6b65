"""Metrics of progress towards the goals: Francis et al. (arXiv 2306.16740), FP, SPL; SEAN; SocNavGym; BARN."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irsim.common.angles import wrap
from irsim.metrics.trajectory import Track
from irsim.navigation.geodesic import Geodesics
from irsim.simulation.roles import HUMAN, ROBOT

__all__ = ["UNREACHABLE", "outcome_metrics", "progress_metrics"]


UNREACHABLE = "unreachable"
"""Flag of a robot to one of whose goals no path was found; metrics that need the shortest path are NaN."""
_WINDOW_S = 5.0
"""Length of the windows of ``failure_to_progress`` [s]."""
_MIN_PROGRESS_M = 0.1
"""Length [m] by which the path to the goal must become shorter in a window."""


def progress_metrics(track: Track, geodesics: Geodesics, radius: float) -> tuple[dict[str, float], list[str]]:
    """Metrics of a robot that refer to the shortest path L* over its goals in turn, and its flags.

    - ``failure_to_progress``: number of successive windows of 5 s in which the shortest path to the present goal (the
      straight line if there is no path) became less than 0.1 m shorter; a window in which the goal changes is progress.
    - ``spl``: success x L*/max(path length, L*) (Anderson et al., arXiv 1807.06757). ``path_efficiency``: path length /
      L*, of robots that arrived. ``stl``: success x T*/max(T, T*), T* = L*/top speed, the greatest of its
      limits forward and sideways. ``barn_score``: success x
      T*/clip(T, 2 T*, 8 T*), T* = L*/2 (Perille et al. 2020; at most 0.5). All NaN without a path to a goal.
    - ``path_irregularity`` [rad]: absolute heading changes minus the heading changes of the shortest path, of
      robots that arrived. For a drive that must turn to move, the shortest path includes the first turn towards it.
    - ``min_distance_to_goal``, ``final_distance_to_goal`` [m]: straight-line distance to the present goal.

    Args:
        track: The robot.
        geodesics: Shortest paths in its world.
        radius: Radius of the disc for which the shortest paths are computed [m].
    """
    nan = math.nan
    straight = np.linalg.norm(track.goal[:, :2] - track.position, axis=1)
    known = straight[~np.isnan(straight)]
    metrics = {
        "failure_to_progress": float(_without_progress(track, geodesics, radius)),
        "spl": 0.0,
        "stl": 0.0,
        "barn_score": 0.0,
        "path_efficiency": nan,
        "path_irregularity": nan,
        "min_distance_to_goal": float(known.min()) if len(known) else nan,
        "final_distance_to_goal": float(known[-1]) if len(known) else nan,
    }
    goals = _goals(track)
    if not len(goals):
        return metrics | dict.fromkeys(("spl", "stl", "barn_score", "failure_to_progress"), nan), []
    ways = [geodesics.path(a, b, radius) for a, b in zip([track.position[0], *goals[:-1]], goals, strict=True)]
    if any(way is None for way in ways):
        return metrics | dict.fromkeys(("spl", "stl", "barn_score"), nan), [UNREACHABLE]
    if track.arrival is None:
        return metrics, []
    way = np.concatenate([w for w in ways if w is not None])
    shortest = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
    path, time = track.path_length, track.arrival * track.step_time
    metrics["path_efficiency"] = path / shortest if shortest > 0 else nan
    metrics["path_irregularity"] = float(np.abs(track.bends).sum()) - _turns(way, track)
    if track.success:
        metrics["spl"] = shortest / max(path, shortest) if shortest > 0 else 1.0
        ideal = shortest / track.top_speed if 0 < track.top_speed < math.inf else nan
        metrics["stl"] = ideal / max(time, ideal) if time > 0 else 1.0
        ideal = shortest / 2.0
        metrics["barn_score"] = ideal / min(max(time, 2 * ideal), 8 * ideal) if ideal > 0 else nan
    return metrics, []


def _goals(track: Track) -> list[NDArray[np.float64]]:
    """The goals of a robot, in turn."""
    goals = track.goal[:, :2]
    goals = goals[~np.isnan(goals).any(axis=1)]
    if not len(goals):
        return []
    changed = np.flatnonzero((np.diff(goals, axis=0) != 0).any(axis=1)) + 1
    return [goals[0], *goals[changed]]


def _without_progress(track: Track, geodesics: Geodesics, radius: float) -> int:
    window = max(1, round(_WINDOW_S / track.step_time))
    count = 0
    for begin in range(0, len(track.pose) - window, window):
        a, b = begin, begin + window
        goal = track.goal[a, :2]
        if np.isnan(goal).any() or (track.goal[b, :2] != goal).any():
            continue
        before, after = (geodesics.length(track.position[row], goal, radius, coarse=True) for row in (a, b))
        if math.isnan(before) or math.isnan(after):  # without a path the straight line counts
            before, after = (float(np.linalg.norm(goal - track.position[row])) for row in (a, b))
        count += before - after < _MIN_PROGRESS_M
    return count


def _turns(way: NDArray[np.float64], track: Track) -> float:
    """Absolute heading changes along a path [rad], including the first turn towards it for drives that need it."""
    legs = np.diff(way, axis=0)
    legs = legs[np.linalg.norm(legs, axis=1) > 0]
    before = [] if track.holonomic else [track.pose[0, 2]]
    angles = np.concatenate([before, np.arctan2(legs[:, 1], legs[:, 0])])
    return float(np.abs(wrap(np.diff(angles))).sum())


def outcome_metrics(track: Track) -> dict[str, float]:
    """Outcome of a robot: exactly one of success, collision (stopped by one, or arrived after one) and time-out.

    - ``success``: arrived within the horizon, and no contact began before or at that step; ``goal_reached`` ignores
      contacts.
    - ``collision_count``: contacts that began (at least one step without before), per unordered pair, until it arrived;
      ``wall_``, ``agent_``, ``human_collisions`` of them by partner. ``collision_steps``: steps in contact.
    - ``contacts_between_steps``: contacts, per unordered pair, with nothing touched at either end of the step, until it
      arrived; ``collision_count`` has them, too, only where ``world.contacts: swept`` makes them collisions.
    - ``success_in_belief``: of a robot that goes by an estimate, whether it believed to have arrived, and no contact
      began before it really did.
    - ``timeout``: neither arrived nor stopped by a collision at the end; a contact after which the robot drives on
      (``world.collision_mode``) counts as a contact, not as the end.
    - ``time_to_goal`` [s]: time of the first arrival; NaN without one. ``driving_time`` [s]: time from when it came
      into the world until it arrived, or to the end.
    - ``arrived_share``: the same as ``goal_reached``; its mean over robots is the share that arrived.
    """
    kinds = [kind for _, kind in track.collisions]
    agents, humans = kinds.count(ROBOT), kinds.count(HUMAN)
    return {
        "success": float(track.success),
        "goal_reached": float(track.arrival is not None),
        "collision_count": float(len(kinds)),
        "collision_steps": float(track.collided[1:].sum()),
        "wall_collisions": float(len(kinds) - agents - humans),
        "agent_collisions": float(agents),
        "human_collisions": float(humans),
        "contacts_between_steps": float(track.between_steps),
        "success_in_belief": float("nan") if track.believed is None else float(track.believed and not track.collisions),
        "timeout": float(track.arrival is None and not (kinds and track.stopped)),
        "arrived_share": float(track.arrival is not None),
        "driving_time": (len(track.pose) - 1) * track.step_time,
        "time_to_goal": float("nan") if track.arrival is None else track.arrival * track.step_time,
    }
