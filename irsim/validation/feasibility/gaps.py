"""Finds the narrow gaps between segments and discs, exactly and at any scale, for worlds too large for fine cells.

A disc can move from one place to another unless a ring of obstacles separates the two places and each gap of the ring
is narrower than the disc. Rings are found as cycles of a graph: obstacles are joined in the order of the gaps between
them, the narrowest first (Kruskal). Each cycle that closes is described by the number of times it crosses the straight
line between the two places. An odd number means that it separates them, so the gap that closes the first such cycle is
the narrowest gap of the widest path.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Gap
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import StartState

__all__ = ["Gaps", "Opening", "Passages", "find_gaps", "outlines_of", "passages_of"]

Point = tuple[float, float]
Shapes = NDArray[np.object_]
"""Shapely geometries."""
_MAX_FEATURES = 40_000
"""Number of segments and discs of a scene."""
_MAX_GAPS = 60_000
"""Number of gaps of a scene."""
_MAX_CANDIDATES = 5_000_000
"""Number of pairs of features whose extents along x overlap, which bounds the work."""
_MAX_CELLS = 500_000
"""Number of occupied cells of a map."""
_MAX_CROSSINGS = 1_000_000
"""Product of gaps and paths that are examined together, which bounds the memory."""


@dataclass(frozen=True)
class Opening:
    """The narrowest gap on the widest path.

    Attributes:
        width: Width of the gap [m]; 0 if there is no opening, infinity if it is wider than the widest gap examined.
        place: Middle of the gap [m].
    """

    width: float
    place: Point


@dataclass(frozen=True)
class Gaps:
    """The obstacles of a scene as features, segments and discs, and the narrow gaps between them.

    Attributes:
        a, b: (F, 2) ends of segments; both are the centre of a disc [m].
        radius: (F,) radius of discs, 0 for segments [m].
        first, second: (P,) features beside each gap, the narrowest gap first.
        at_first, at_second: (P, 2) nearest points of the two segments or centres [m].
        width: (P,) width of each gap [m]; between an obstacle and an open edge of the world twice the distance, because
            only the centre of a body must stay inside.
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
    def max_paths(self) -> int:
        """Maximum number of paths that :meth:`openings` takes."""
        return _MAX_CROSSINGS // max(1, len(self.first))

    def openings(self, ways: list[tuple[Point, Point]]) -> list[Opening]:
        """Find the narrowest gap on the widest path of each pair of places.

        Args:
            ways: Start and end of each path [m]; neither may be in or at an obstacle.
        """
        openings = [Opening(math.inf, goal) for _, goal in ways]
        if not ways or not len(self.first):
            return openings
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
                        openings[way] = opening
                if not left:
                    break
        return openings

    def _crossings(self, ways: Floats) -> NDArray[np.bool_]:
        """(P, K) whether the connection through each gap crosses each straight line an odd number of times.

        The connection leads from the first end of one feature through the gap to the first end of the other.
        """
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
        """Return the middle of a gap."""
        p, q = self.at_first[k], self.at_second[k]
        apart = math.dist(p, q)
        share = 0.5 + (self.radius[self.first[k]] - self.radius[self.second[k]]) / (2 * apart) if apart > 0 else 0.5
        x, y = p + min(1.0, max(0.0, share)) * (q - p)
        return float(x), float(y)


def find_gaps(scene: StartState, *, most: float, open_edge: bool) -> Gaps | None:
    """Find the narrow gaps of a scene.

    Args:
        scene: The scene.
        most: Gaps of this width or more are ignored [m].
        open_edge: The edge of the world is not a wall, but no path may leave the world.

    Returns:
        The gaps; None if the scene has too many features or gaps.
    """
    lines: list[tuple[Floats, float]] = []
    count = 0
    for parts, pose in scene.things:
        for part in parts:
            if isinstance(part, core.GridCells) and part.grid.count > _MAX_CELLS:
                return None
            new = list(outlines_of(part, pose))
            lines += new
            count += sum(len(points) - 1 for points, _ in new)
            if count > _MAX_FEATURES:
                return None
    solid = count
    if open_edge:
        x0, y0, x1, y1 = scene.bounds
        lines.append((np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]), 0.0))
    a = np.concatenate([points[:-1] for points, _ in lines])
    b = np.concatenate([points[1:] for points, _ in lines])
    radius = np.concatenate([np.full(len(points) - 1, r) for points, r in lines])
    shapes = _shapes(a, b)
    pairs = _near_pairs(a, b, radius, most, shapes)
    if pairs is None:
        return None
    i, j = pairs
    # of parallel walls any points are nearest; in this order GEOS prefers the ends of the first wall
    q, p = shapely.get_coordinates(shapely.shortest_line(shapes[j], shapes[i])).reshape(-1, 2, 2).swapaxes(0, 1)
    width = np.maximum(np.hypot(*(p - q).T) - radius[i] - radius[j], 0.0)
    width = np.where((i >= solid) != (j >= solid), 2 * width, width)
    near = np.flatnonzero(width < most)
    near = near[np.argsort(width[near], kind="stable")]
    if len(near) > _MAX_GAPS:
        return None
    return Gaps(a, b, radius, i[near], j[near], p[near], q[near], width[near])


def outlines_of(part: core.Part, pose: list[float]) -> Iterator[tuple[Floats, float]]:
    """Return the polylines of a part in the world frame, each with its radius; a disc has one segment of length 0."""
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


def _near_pairs(a: Floats, b: Floats, radius: Floats, most: float, shapes: Shapes) -> NDArray[np.int64] | None:
    """Find the pairs of features whose gaps may be narrower than ``most`` [m].

    Returns:
        (2, P) features beside a gap, the smaller index first, from left to right; None if too many pairs would have
        to be examined.
    """
    low = np.minimum(a[:, 0], b[:, 0]) - radius
    high = np.maximum(a[:, 0], b[:, 0]) + radius + most
    order = np.argsort(low, kind="stable")
    overlaps = np.searchsorted(low[order], high[order], side="right") - np.arange(len(order)) - 1
    if overlaps.sum() > _MAX_CANDIDATES:
        return None
    reach = most + radius + radius.max()
    pairs = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=reach)
    pairs = pairs[:, pairs[0] < pairs[1]]
    rank = np.argsort(order)[pairs]
    return pairs[:, np.lexsort((rank.max(axis=0), rank.min(axis=0)))]


def _shapes(a: Floats, b: Floats) -> Shapes:
    """Make a shapely segment of each feature, and a point of each disc."""
    shapes = np.asarray(shapely.linestrings(np.stack([a, b], axis=1)), dtype=object)
    discs = (a == b).all(axis=1)
    shapes[discs] = shapely.points(a[discs])
    return shapes


_SLACK = 1e-6
"""Share by which a gap may be narrower than a robot because of rounding."""
_MIN_RADIUS_SHARE = 0.25
"""Smallest share of a robot's radius that its disc may keep when places only sample its arrival region."""
_MAX_PLACES = 100
"""Number of places that sample the region in which a robot counts as arrived."""


@dataclass(frozen=True)
class Passages:
    """Narrowest gaps on the paths of some movers.

    Attributes:
        barriers: The obstacles and the gaps between them.
        gaps: (object id, index of the goal) -> the narrowest gap on the widest path (None if all gaps are wide), and
            whether that gap is too narrow for the body. Paths that were not examined are missing.
    """

    barriers: Gaps
    gaps: dict[tuple[int, int], tuple[Gap | None, bool]]


def passages_of(
    context: Context, scene: StartState, movers: list[Mover], blocked_goals: set[tuple[int, int]], *, ease: float
) -> Passages | None:
    """Find the narrowest gaps on the paths of movers for which cells are too coarse.

    Args:
        context: The scenario.
        scene: The initial poses and goals.
        movers: The movers.
        blocked_goals: (object id, index of the goal) pairs whose goal lies in or too near to an obstacle.
        ease: A gap counts as wide if it is this many times as wide as the robot.

    Returns:
        The gaps, None if there are too many obstacles.
    """
    open_edge = context.scenario.world.boundary == "none"
    key = f"barriers {max(m.radius for m in movers)}"
    if key not in scene.owner.kept:
        most = 2 * ease * max(m.radius for m in movers)
        scene.owner.kept[key] = find_gaps(scene.owner, most=most, open_edge=open_edge)
    barriers: Gaps | None = scene.owner.kept[key]
    if barriers is None:
        return None
    ways: list[tuple[Point, Point]] = []
    asked: list[tuple[tuple[int, int], Mover, float, range]] = []
    gaps: dict[tuple[int, int], tuple[Gap | None, bool]] = {}
    for mover in movers:
        if mover.record.wander:
            continue
        start = mover.centre(scene.pose[mover.record.id])
        for index, goal in enumerate(scene.goals[mover.record.id]):
            places, radius = _arrival_places(scene, mover, (goal[0], goal[1]))
            if (mover.record.id, index) in blocked_goals or len(ways) + len(places) > barriers.max_paths:
                break
            if not places:  # the arrival region is too large to sample
                gaps[mover.record.id, index] = None, False
                start = (goal[0], goal[1])
                continue
            asked.append(((mover.record.id, index), mover, radius, range(len(ways), len(ways) + len(places))))
            ways += [(start, place) for place in places]
            start = places[0]
    openings = barriers.openings(ways)
    for pair, mover, radius, of_mover in asked:
        widest = max((openings[k] for k in of_mover), key=lambda opening: opening.width)
        closed = widest.width < 2 * radius * (1 - _SLACK)
        narrow = closed or 2 * mover.radius <= widest.width < 2 * ease * mover.radius
        gaps[pair] = (Gap(widest.width, widest.place, 0.0) if narrow else None, closed)
    return Passages(barriers, gaps)


def _arrival_places(scene: StartState, mover: Mover, goal: Point) -> tuple[list[Point], float]:
    """Places that sample the region in which a mover counts as arrived.

    Returns:
        The places, and the radius of a disc that can reach one of them whenever the body can reach the region.
    """
    if not _hits(scene, goal, mover.radius + mover.reach):
        return [goal], mover.radius
    apart = mover.reach * math.sqrt(math.pi / _MAX_PLACES)
    radius = mover.radius - apart * math.sqrt(0.5)
    if radius < _MIN_RADIUS_SHARE * mover.radius:
        return [], 0.0
    count = math.ceil(mover.reach / apart) + 1
    around = mover.reach + apart
    steps = [(apart * i, apart * j) for i in range(-count, count + 1) for j in range(-count, count + 1)]
    steps.sort(key=lambda step: math.hypot(*step))
    places = [(goal[0] + dx, goal[1] + dy) for dx, dy in steps if math.hypot(dx, dy) <= around]
    return [place for place in places if not _hits(scene, place, radius)], radius


def _hits(scene: StartState, place: Point, radius: float) -> bool:
    return scene.terrain.collides([core.Circle(radius=radius, center=[0, 0])], (*place, 0.0))
