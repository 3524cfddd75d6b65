"""Judges an episode from the poses alone, with the same code for every simulator.

Robots are discs, walls solid outlines. Between two poses a disc moves on the straight line between them, which is the
motion of both simulators under Euler's method; so the least distance of two discs, or of a disc and an edge, within a
step has a closed form. Bodies touch where their outlines overlap by more than `TOUCH_M`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["STILL_S", "TOUCH_M", "Judge", "Verdict", "at_ends", "at_rest", "within_steps"]

Floats = NDArray[np.float64]

TOUCH_M = 1e-6
"""Overlap from which on bodies touch."""
STILL_S = 5.0
"""Time in which at least one robot has to move by a millimetre; otherwise the episode is stuck."""


@dataclass(frozen=True)
class Verdict:
    """Result of one start.

    Attributes:
        outcome: ``a`` all robots arrived, or got across and went on to the time limit; ``c`` bodies touch at the end of
            a step, which ends the episode; ``t`` time is up, or no robot moves any more.
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
        """Whether all robots arrived without a contact, within steps or at their ends."""
        return self.outcome == "a" and self.between == 0

    @property
    def touched(self) -> bool:
        """Whether a robot touched anything, at the end of a step or within one."""
        return self.outcome == "c" or self.between > 0


@dataclass(frozen=True)
class Judge:
    """Judges the episodes of one start.

    Attributes:
        goals: (N, 2) where each robot wants to go [m].
        walls: (K, 2) corners of each solid outline [m].
        radius: Radius of every robot [m].
        threshold: A robot nearer to its goal than this has arrived [m].
        dt: Length of a step [s].
        loop: Whether robots turn round at their goals and go on until the time limit.
    """

    goals: Any
    walls: list[Any]
    radius: float
    threshold: float
    dt: float
    loop: bool = False

    def ended(self, places: Any) -> bool:
        """Whether a robot touches something at one of these moments, or all have arrived; (T, N, 2) positions [m]."""
        path = np.asarray(places, dtype=np.float64)
        if at_ends(path, self.walls, self.radius).min(initial=np.inf) < -TOUCH_M:
            return True
        return not self.loop and bool(self._near(path).all(axis=1).any())

    def verdict(self, places: Any) -> Verdict:
        """Judge an episode that has ended, or whose time is up.

        Args:
            places: (T + 1, N, 2) positions at the start and after each of T steps [m].
        """
        path = np.asarray(places, dtype=np.float64)
        ends, within = at_ends(path, self.walls, self.radius), within_steps(path, self.walls, self.radius)
        near = self._near(path)
        touched = np.flatnonzero((ends < -TOUCH_M).any(axis=1))[:1].tolist()
        done = np.flatnonzero(near.all(axis=1))[:1].tolist() if not self.loop else []
        last, outcome = len(path) - 1, "t"
        if touched and (not done or touched[0] <= done[0]):
            last, outcome = touched[0], "c"
        elif done:
            last, outcome = done[0], "a"
        elif self.loop and near.any(axis=0).all() and not at_rest(path, self.dt):
            outcome = "a"
        return _verdict(outcome, last, ends, within, self.dt)

    def _near(self, path: Floats) -> NDArray[np.bool_]:
        off = path - np.asarray(self.goals, dtype=np.float64)
        return np.asarray(np.hypot(off[..., 0], off[..., 1]) < self.threshold)


def _verdict(outcome: str, last: int, ends: Floats, within: Floats, dt: float) -> Verdict:
    swept, clear = within[:last] < -TOUCH_M, (ends[:last] >= -TOUCH_M) & (ends[1 : last + 1] >= -TOUCH_M)
    between = swept & clear
    deepest = np.where(between, -within[:last], 0.0).max(initial=0.0)
    if outcome == "c":
        deepest = max(deepest, float(-ends[last].min()))
    return Verdict(outcome, round(last * dt, 6), int(between.sum()), float(deepest))


def at_rest(places: Any, dt: float) -> bool:
    """Whether no robot has moved by a millimetre for a while."""
    steps = round(STILL_S / dt)
    if len(places) <= steps:
        return False
    recent = np.asarray(places[-steps - 1 :], dtype=np.float64)
    return bool((np.ptp(recent, axis=0) < 1e-3).all())


def at_ends(path: Floats, walls: list[Any], radius: float) -> Floats:
    """Distances between outlines, negative where they overlap.

    Args:
        path: (T, N, 2) positions [m].
        walls: (K, 2) corners of each solid outline [m].
        radius: Radius of every robot [m].

    Returns:
        (T, P) for all pairs of robots, then for each robot and each edge of a wall.
    """
    i, j = np.triu_indices(path.shape[1], 1)
    apart = path[:, i] - path[:, j]
    pairs = np.hypot(apart[..., 0], apart[..., 1]) - 2 * radius
    if not walls:
        return np.asarray(pairs)
    a, b = _edges(walls)
    return np.concatenate([pairs, _flat(_to_edges(path[:, :, None], a, b)) - radius], axis=1)


def within_steps(path: Floats, walls: list[Any], radius: float) -> Floats:
    """The least of these distances within each step: (T + 1, N, 2) positions → (T, P)."""
    i, j = np.triu_indices(path.shape[1], 1)
    pairs = _nearest_origin(path[:, i] - path[:, j]) - 2 * radius
    if not walls:
        return pairs
    return np.concatenate([pairs, _flat(_chords_to_edges(path[:, :, None], *_edges(walls))) - radius], axis=1)


def _edges(walls: list[Any]) -> tuple[Floats, Floats]:
    rings = [np.asarray(corners, dtype=np.float64) for corners in walls]
    return np.concatenate(rings), np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])


def _flat(values: Floats) -> Floats:
    return values.reshape(len(values), -1)


def _nearest_origin(points: Floats) -> Floats:
    """Least distance of the origin from each chord between successive points: (T + 1, …, 2) → (T, …)."""
    start, way = points[:-1], np.diff(points, axis=0)
    square = (way * way).sum(axis=-1)
    share = np.clip(-(start * way).sum(axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    nearest = start + share[..., None] * way
    return np.asarray(np.hypot(nearest[..., 0], nearest[..., 1]))


def _to_edges(points: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of points from segments: (T, N, 1, 2) → (T, N, E)."""
    way = b - a
    share = np.clip(((points - a) * way).sum(axis=-1) / (way * way).sum(axis=-1), 0.0, 1.0)
    off = points - (a + share[..., None] * way)
    return np.asarray(np.hypot(off[..., 0], off[..., 1]))


def _chords_to_edges(path: Floats, a: Floats, b: Floats) -> Floats:
    """Distance of each chord of each robot from each segment; 0 where they cross: (T + 1, N, 1, 2) → (T, N, E)."""
    ends = _to_edges(path, a, b)
    corners = np.minimum(_nearest_origin(path - a), _nearest_origin(path - b))
    start, end = path[:-1], path[1:]
    way, edge = end - start, b - a

    def side(u: Floats, v: Floats) -> Floats:
        return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])

    crossed = (side(start - a, edge) * side(end - a, edge) < 0) & (side(way, a - start) * side(way, b - start) < 0)
    return np.where(crossed, 0.0, np.minimum(np.minimum(ends[:-1], ends[1:]), corners))
