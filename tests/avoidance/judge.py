"""What happened in an episode, from the poses alone: the same code for every simulator.

Robots are discs, walls solid outlines. Between two poses a disc moves on the straight line between them, which is the
motion of both simulators under Euler's method; so the least distance of two discs, or of a disc and an edge, within a
step has a closed form. Bodies touch where their outlines overlap by more than `TOUCH_M`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["STILL_S", "TOUCH_M", "Verdict", "at_rest", "clearances", "judge", "judge_end"]

Floats = NDArray[np.float64]

TOUCH_M = 1e-6
"""Overlap from which on bodies touch."""
STILL_S = 5.0
"""Time in which somebody has to move by a millimetre; an episode in which nobody does has got stuck."""


@dataclass(frozen=True)
class Verdict:
    """What became of one start.

    Attributes:
        outcome: ``a`` everybody arrived, or got across and went on to the time limit; ``c`` bodies touch at the end of
            a step, which ends the episode; ``t`` time is up, or nobody moves any more.
        seconds: Time of the arrival, of the contact, or of the end [s].
        between: Number of pairs and steps in which bodies touch within a step but at neither of its ends, up to the
            outcome.
        depth_m: Greatest overlap of these contacts and of the one that ended the episode [m].
    """

    outcome: str
    seconds: float
    between: int
    depth_m: float

    @property
    def success(self) -> bool:
        """Whether everybody arrived and nobody touched anything, within steps neither."""
        return self.outcome == "a" and self.between == 0

    @property
    def touched(self) -> bool:
        """Whether anybody touched anything, at the end of a step or within one."""
        return self.outcome == "c" or self.between > 0


def judge(
    places: Any, goals: Any, walls: list[Any], *, radius: float, threshold: float, dt: float, loop: bool = False
) -> Verdict | None:
    """Judge the steps so far.

    Args:
        places: (T + 1, N, 2) positions at the start and after each of T steps [m].
        goals: (N, 2) where each robot wants to go [m].
        walls: (K, 2) corners of each solid outline [m].
        radius: Radius of every robot [m].
        threshold: A robot nearer to its goal than this has arrived [m].
        dt: Length of a step [s].
        loop: Whether robots turn round at their goals and go on until the time limit.

    Returns:
        The outcome; None where there is none yet.
    """
    path = np.asarray(places, dtype=np.float64)
    ends, within = clearances(path, walls, radius)
    first = np.flatnonzero((ends < -TOUCH_M).any(axis=1))
    near = np.hypot(*np.moveaxis(path - np.asarray(goals, dtype=np.float64), 2, 0)) < threshold
    done = np.flatnonzero(near.all(axis=1)) if not loop else np.zeros(0, dtype=np.intp)
    last = min([*first[:1].tolist(), *done[:1].tolist()], default=None)
    if last is None:
        return None
    outcome = "c" if first.size and first[0] == last else "a"
    return _verdict(outcome, last, ends, within, dt)


def judge_end(
    places: Any, goals: Any, walls: list[Any], *, radius: float, threshold: float, dt: float, loop: bool = False
) -> Verdict:
    """Judge an episode whose time is up; arguments as for :func:`judge`."""
    early = judge(places, goals, walls, radius=radius, threshold=threshold, dt=dt, loop=loop)
    if early is not None:
        return early
    path = np.asarray(places, dtype=np.float64)
    ends, within = clearances(path, walls, radius)
    steps, outcome = len(path) - 1, "t"
    if loop:
        near = np.hypot(*np.moveaxis(path - np.asarray(goals, dtype=np.float64), 2, 0)) < threshold
        if near.any(axis=0).all() and not at_rest(path, dt):
            outcome = "a"
    return _verdict(outcome, steps, ends, within, dt)


def _verdict(outcome: str, last: int, ends: Floats, within: Floats, dt: float) -> Verdict:
    swept, clear = within[:last] < -TOUCH_M, (ends[:last] >= -TOUCH_M) & (ends[1 : last + 1] >= -TOUCH_M)
    between = swept & clear
    deepest = np.where(between, -within[:last], 0.0).max(initial=0.0)
    if outcome == "c":
        deepest = max(deepest, float(-ends[last].min()))
    return Verdict(outcome, round(last * dt, 6), int(between.sum()), float(deepest))


def at_rest(places: Any, dt: float) -> bool:
    """Whether nobody has moved by a millimetre for a while."""
    path = np.asarray(places, dtype=np.float64)
    steps = round(STILL_S / dt)
    if len(path) <= steps:
        return False
    recent = path[-steps - 1 :]
    return bool((np.ptp(recent, axis=0) < 1e-3).all())


def clearances(path: Floats, walls: list[Any], radius: float) -> tuple[Floats, Floats]:
    """Distances between outlines, negative where they overlap.

    Args:
        path: (T + 1, N, 2) positions [m].
        walls: (K, 2) corners of each solid outline [m].
        radius: Radius of every robot [m].

    Returns:
        (T + 1, P) at the ends of steps and (T, P) the least within each step, for all pairs of robots, then for each
        robot and edge of a wall.
    """
    count = path.shape[1]
    i, j = np.triu_indices(count, 1)
    apart = path[:, i] - path[:, j]
    ends, within = [np.hypot(apart[..., 0], apart[..., 1]) - 2 * radius], [_nearest_origin(apart) - 2 * radius]
    for corners in walls:
        ring = np.asarray(corners, dtype=np.float64)
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            ends.append(_to_edge(path, a, b) - radius)
            within.append(_chord_to_edge(path, a, b) - radius)
    return np.concatenate(ends, axis=1), np.concatenate(within, axis=1)


def _nearest_origin(points: Floats) -> Floats:
    """Least distance of the origin from each chord between successive points: (T + 1, P, 2) → (T, P)."""
    start, way = points[:-1], np.diff(points, axis=0)
    square = (way * way).sum(axis=-1)
    share = np.clip(-(start * way).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    nearest = start + share[..., None] * way
    return np.asarray(np.hypot(nearest[..., 0], nearest[..., 1]))


def _to_edge(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of points from a segment: (…, 2) → (…)."""
    way = b - a
    share = np.clip(((points - a) @ way) / (way @ way), 0.0, 1.0)
    off = points - (a + share[..., None] * way)
    return np.asarray(np.hypot(off[..., 0], off[..., 1]))


def _chord_to_edge(path: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of each chord of each robot from a segment; 0 where they cross: (T + 1, N, 2) → (T, N)."""
    start, end = path[:-1], path[1:]
    ends = np.minimum(_to_edge(start, a, b), _to_edge(end, a, b))
    corners = np.minimum(_nearest_origin(path - a), _nearest_origin(path - b))
    way = end - start

    def side(u: Floats, v: Floats) -> Floats:
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    edge = b - a
    crossed = (side(start - a, edge) * side(end - a, edge) < 0) & (side(way, a - start) * side(way, b - start) < 0)
    return np.where(crossed, 0.0, np.minimum(ends, corners))
