"""How well it made its way: Francis et al. (arXiv 2306.16740), FP, SPL; SEAN; SocNavGym; BARN."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from irsim.metrics.geodesic import Geodesics
from irsim.metrics.trajectory import Track, wrapped

__all__ = ["UNREACHABLE", "progress"]

UNREACHABLE = "unreachable"
"""Flag of a robot: no way to a goal of its was found, so that what needs the shortest way is NaN."""
_WINDOW, _LEAST = 5.0, 0.1  # [s], [m]


def progress(track: Track, geodesics: Geodesics, radius: float) -> tuple[dict[str, float], list[str]]:
    """What compares with the shortest way L*, over the goals in turn; and what is odd.

    - ``failure_to_progress``: windows of 5 s, one after the other, in which the shortest way to the present goal became
      less than 0.1 m shorter (where there is none, the straight line); a window in which the goal changed is progress.
    - ``spl``: success x L*/max(path length, L*) (Anderson et al., arXiv 1807.06757). ``path_efficiency``: path length /
      L*, of robots that arrived. ``stl``: success x T*/max(T, T*), T* = L*/top speed, the greatest of its
      limits forward and sideways. ``barn_score``: success x
      T*/clip(T, 2 T*, 8 T*), T* = L*/2 (Perille et al. 2020; at most 0.5). All NaN where there is no way to a goal.
    - ``path_irregularity`` [rad]: absolute heading changes minus those of the shortest way, of robots that arrived.
      Where the body has to turn to move, the shortest way begins with the turn towards it.
    - ``min_distance_to_goal``, ``final_distance_to_goal`` [m]: to the present goal, straight.

    Args:
        track: The robot.
        geodesics: Shortest ways in its world.
        radius: Of the disc that goes them [m].
    """
    nan = math.nan
    straight = np.linalg.norm(track.goal[:, :2] - track.position, axis=1)
    known = straight[~np.isnan(straight)]
    found = {
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
        return found | dict.fromkeys(("spl", "stl", "barn_score", "failure_to_progress"), nan), []
    ways = [geodesics.way(a, b, radius) for a, b in zip([track.position[0], *goals[:-1]], goals, strict=True)]
    if any(way is None for way in ways):
        return found | dict.fromkeys(("spl", "stl", "barn_score"), nan), [UNREACHABLE]
    if track.arrival is None:
        return found, []
    way = np.concatenate([w for w in ways if w is not None])
    shortest = float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())
    path, time = track.path_length, track.arrival * track.step_time
    found["path_efficiency"] = path / shortest if shortest > 0 else nan
    found["path_irregularity"] = float(np.abs(track.bends).sum()) - _turns(way, track)
    if track.success:
        found["spl"] = shortest / max(path, shortest) if shortest > 0 else 1.0
        ideal = shortest / track.top_speed if 0 < track.top_speed < math.inf else nan
        found["stl"] = ideal / max(time, ideal) if time > 0 else 1.0
        ideal = shortest / 2.0
        found["barn_score"] = ideal / min(max(time, 2 * ideal), 8 * ideal) if ideal > 0 else nan
    return found, []


def _goals(track: Track) -> list[NDArray[np.float64]]:
    """The goals it had, in turn."""
    goals = track.goal[:, :2]
    goals = goals[~np.isnan(goals).any(axis=1)]
    if not len(goals):
        return []
    changed = np.flatnonzero((np.diff(goals, axis=0) != 0).any(axis=1)) + 1
    return [goals[0], *goals[changed]]


def _without_progress(track: Track, geodesics: Geodesics, radius: float) -> int:
    window = max(1, round(_WINDOW / track.step_time))
    count = 0
    for begin in range(0, len(track.pose) - window, window):
        a, b = begin, begin + window
        goal = track.goal[a, :2]
        if np.isnan(goal).any() or (track.goal[b, :2] != goal).any():
            continue
        before, after = (geodesics.length(track.position[row], goal, radius, coarse=True) for row in (a, b))
        if math.isnan(before) or math.isnan(after):  # no way: as the crow flies
            before, after = (float(np.linalg.norm(goal - track.position[row])) for row in (a, b))
        count += before - after < _LEAST
    return count


def _turns(way: NDArray[np.float64], track: Track) -> float:
    """Absolute heading changes of one who goes a way [rad]; if it cannot go sideways, it first turns towards it."""
    legs = np.diff(way, axis=0)
    legs = legs[np.linalg.norm(legs, axis=1) > 0]
    before = [] if track.holonomic else [track.pose[0, 2]]
    angles = np.concatenate([before, np.arctan2(legs[:, 1], legs[:, 0])])
    return float(np.abs(wrapped(np.diff(angles))).sum())
