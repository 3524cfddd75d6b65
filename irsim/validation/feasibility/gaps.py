"""Gaps between straight things and discs, exactly and at any scale, for worlds too large to lay fine cells over.

A disc gets from one place to another unless a ring of things lies between the two in which each gap is narrower than
the disc. Rings are found as cycles: things are joined from the narrowest gap on (Kruskal), and each cycle that closes
is told by how many times it crosses the straight line from place to place. An odd number separates them, so the gap
that closes the first such cycle is the narrowest gap on the widest way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.validation.feasibility.scenes import Scene

__all__ = ["Barriers", "Opening", "barriers_of"]

Point = tuple[float, float]
Floats = NDArray[np.float64]
_MOST_FEATURES, _MOST_PAIRS, _MOST_CANDIDATES = 40_000, 60_000, 5_000_000
_MOST_CELLS = 500_000
"""Occupied ones of a map."""
_MOST_CROSSINGS = 1_000_000
"""Pairs times ways that are looked at at once."""


@dataclass(frozen=True)
class Opening:
    """The narrowest gap on the widest way.

    Attributes:
        width: How wide, 0 if there is no opening; infinity if it is wider than was asked for [m].
        place: Where [m].
    """

    width: float
    place: Point


@dataclass(frozen=True)
class Barriers:
    """What stands in the way, and which gaps are narrow.

    Attributes:
        a, b: (F, 2) ends of segments, twice the middle of a disc [m].
        radius: (F,) of a disc, 0 of a segment [m].
        first, second: (P,) features beside a gap, the narrowest gap first.
        at_first, at_second: (P, 2) nearest points of the segments and middles [m].
        width: (P,) of gaps; twice the distance to an edge of the world that is open, where only a middle must pass [m].
    """

    a: Floats
    b: Floats
    radius: Floats
    first: NDArray[np.int64]
    second: NDArray[np.int64]
    at_first: Floats
    at_second: Floats
    width: Floats

    @property
    def most_ways(self) -> int:
        """How many can be asked for at once."""
        return _MOST_CROSSINGS // max(1, len(self.first))

    def openings(self, ways: list[tuple[Point, Point]]) -> list[Opening]:
        """The narrowest gaps on the widest ways from place to place, neither of them in or at an obstacle."""
        found = [Opening(math.inf, goal) for _, goal in ways]
        if not ways or not len(self.first):
            return found
        crossed = self._crossings(np.array(ways, dtype=float))
        packed = np.packbits(crossed, axis=1, bitorder="little")
        masks = [int.from_bytes(row.tobytes(), "little") for row in packed]
        up, signs = list(range(len(self.a))), [0] * len(self.a)
        left = (1 << len(ways)) - 1
        for k, (i, j) in enumerate(zip(self.first.tolist(), self.second.tolist(), strict=True)):
            sign = masks[k]
            while up[i] != i:
                signs[i] ^= signs[up[i]]
                sign ^= signs[i]
                up[i] = i = up[up[i]]
            while up[j] != j:
                signs[j] ^= signs[up[j]]
                sign ^= signs[j]
                up[j] = j = up[up[j]]
            if i != j:
                up[i], signs[i] = j, sign
                continue
            closed = sign & left
            if closed:
                left &= ~closed
                opening = Opening(float(self.width[k]), self._middle(k))
                for way in range(len(ways)):
                    if closed >> way & 1:
                        found[way] = opening
                if not left:
                    break
        return found

    def _crossings(self, ways: Floats) -> NDArray[np.bool_]:
        """(P, K) whether the way from feature to feature, from end to end, crosses straight lines oddly often."""
        start, along = ways[:, 0], ways[:, 1] - ways[:, 0]
        corners = (self.a[self.first], self.at_first, self.at_second, self.a[self.second])
        length = np.maximum((along**2).sum(axis=1), 1e-300)
        side, share = [], []
        for corner in corners:
            dx, dy = corner[:, None, 0] - start[:, 0], corner[:, None, 1] - start[:, 1]
            side.append(along[:, 0] * dy - along[:, 1] * dx)
            share.append((along[:, 0] * dx + along[:, 1] * dy) / length)
        odd = np.zeros(side[0].shape, dtype=bool)
        for k in range(3):
            over = (side[k] > 0) != (side[k + 1] > 0)
            part = np.where(over, side[k] / np.where(over, side[k] - side[k + 1], 1.0), 0.0)
            at = share[k] + part * (share[k + 1] - share[k])
            odd ^= over & (at > 0) & (at < 1)
        return odd

    def _middle(self, k: int) -> Point:
        """Of a gap."""
        p, q = self.at_first[k], self.at_second[k]
        apart = math.dist(p, q)
        share = 0.5 + (self.radius[self.first[k]] - self.radius[self.second[k]]) / (2 * apart) if apart > 0 else 0.5
        x, y = p + min(1.0, max(0.0, share)) * (q - p)
        return float(x), float(y)


def barriers_of(scene: Scene, *, most: float, open_edge: bool) -> Barriers | None:
    """The barriers of a scene; None if they are too many.

    Args:
        scene: Whose.
        most: Wider gaps are none [m].
        open_edge: The edge of the world is no wall, but nobody shall go over it.
    """
    lines: list[tuple[Floats, float]] = []
    count = 0
    for parts, pose in scene.things:
        for part in parts:
            if isinstance(part, core.GridCells) and part.grid.count > _MOST_CELLS:
                return None
            new = list(_lines(part, pose))
            lines += new
            count += sum(len(points) - 1 for points, _ in new)
            if count > _MOST_FEATURES:
                return None
    solid = count
    if open_edge:
        x0, y0, x1, y1 = scene.bounds
        lines.append((np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]), 0.0))
    a = np.concatenate([points[:-1] for points, _ in lines])
    b = np.concatenate([points[1:] for points, _ in lines])
    radius = np.concatenate([np.full(len(points) - 1, r) for points, r in lines])
    pairs = _candidates(a, b, radius, most)
    if pairs is None:
        return None
    i, j = pairs
    p, q = _nearest(a[i], b[i], a[j], b[j])
    width = np.maximum(np.hypot(*(p - q).T) - radius[i] - radius[j], 0.0)
    width = np.where((i >= solid) != (j >= solid), 2 * width, width)
    near = np.flatnonzero(width < most)
    near = near[np.argsort(width[near], kind="stable")]
    if len(near) > _MOST_PAIRS:
        return None
    return Barriers(a, b, radius, i[near], j[near], p[near], q[near], width[near])


def _lines(part: core.Part, pose: list[float]) -> Iterator[tuple[Floats, float]]:
    """Polylines of a part, world frame, and how thick they are: a disc is a short one."""
    if isinstance(part, core.GridCells):
        for ring in part.grid.outline():
            yield np.concatenate([ring, ring[:1]]), 0.0
        return
    points, radius = np.zeros((0, 2)), 0.0
    if isinstance(part, core.Circle):
        points, radius = np.array([part.center, part.center], dtype=float), part.radius
    elif isinstance(part, (core.Polygon, core.Linestring, core.Room)):
        points = np.array(part.vertices, dtype=float)
    if not isinstance(part, (core.Circle, core.Linestring)):
        points = np.concatenate([points, points[:1]])
    x, y, theta = pose
    cos, sin = math.cos(theta), math.sin(theta)
    yield points @ np.array([[cos, sin], [-sin, cos]]) + (x, y), radius


def _candidates(
    a: Floats, b: Floats, radius: Floats, most: float
) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
    """Pairs whose boxes are near enough; None if there are too many to look at."""
    low, high = np.minimum(a, b) - radius[:, None], np.maximum(a, b) + radius[:, None] + most
    order = np.argsort(low[:, 0], kind="stable")
    last = np.searchsorted(low[order, 0], high[order, 0], side="right")
    counts = last - np.arange(len(order)) - 1
    total = int(counts.sum())
    if total > _MOST_CANDIDATES:
        return None
    left = np.repeat(np.arange(len(order)), counts)
    right = left + 1 + np.arange(total) - np.repeat(np.cumsum(counts) - counts, counts)
    i, j = order[left], order[right]
    meet = (low[i, 1] <= high[j, 1]) & (low[j, 1] <= high[i, 1])
    return np.minimum(i[meet], j[meet]), np.maximum(i[meet], j[meet])


def _nearest(a: Floats, b: Floats, c: Floats, d: Floats) -> tuple[Floats, Floats]:
    """(M, 2) nearest points of segments a to b and of segments c to d."""
    best = np.full(len(a), math.inf)
    p, q = a.copy(), c.copy()

    def offer(first: Floats, second: Floats, where: NDArray[np.bool_] | None = None) -> None:
        apart = ((first - second) ** 2).sum(axis=1)
        better = apart < best if where is None else where
        best[better] = 0.0 if where is not None else apart[better]
        p[better], q[better] = first[better], second[better]

    offer(a, _on(a, c, d))
    offer(b, _on(b, c, d))
    offer(_on(c, a, b), c)
    offer(_on(d, a, b), d)
    u, v, w = b - a, d - c, c - a
    across = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    some = across != 0
    safe = np.where(some, across, 1.0)
    t = (w[:, 0] * v[:, 1] - w[:, 1] * v[:, 0]) / safe
    s = (w[:, 0] * u[:, 1] - w[:, 1] * u[:, 0]) / safe
    cut = some & (t >= 0) & (t <= 1) & (s >= 0) & (s <= 1)
    at = a + t[:, None] * u
    offer(at, at, cut)
    return p, q


def _on(p: Floats, a: Floats, b: Floats) -> Floats:
    """(M, 2) points of segments nearest to points."""
    along = b - a
    length = (along**2).sum(axis=1)
    t = np.clip(((p - a) * along).sum(axis=1) / np.where(length > 0, length, 1.0), 0.0, 1.0)
    nearest: Floats = a + t[:, None] * along
    return nearest
