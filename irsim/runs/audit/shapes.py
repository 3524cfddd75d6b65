"""The outlines of a recorded run as shapely geometries: where they are at a pose, how far apart, whether they overlap.

A circle is its centre and a radius, never a polygon, so that distances are exact. A map is the boxes of its occupied
cells, joined along rows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.runs.audit.record import PartFacts

__all__ = ["TOLERANCE_M", "Placed", "Shape", "gap", "overlap", "signed_gap"]

TOLERANCE_M = 1e-7
"""Bodies that are nearer to each other, or overlap less, touch within the tolerance [m]."""


@dataclass(frozen=True)
class Placed:
    """A part of a body at a pose, in the world frame.

    Attributes:
        kind: Kind of the part, see :class:`irsim.runs.audit.record.PartFacts`.
        geometry: Its points, line or area, of a circle the centre; of a map a tree of the boxes of its cells.
        radius: Radius around the geometry [m].
        core: The area without its rim of the width :data:`TOLERANCE_M`; None but for polygons.
    """

    kind: str
    geometry: Any
    radius: float = 0.0
    core: Any = None


class Shape:
    """The outline of a body.

    Args:
        parts: Its parts, body frame.
        cells: Cells of the map, its corner and the extent of a cell, for the part that is a map.

    Attributes:
        reach: Largest distance of a point of it from its origin [m].
        is_map: Whether it is a map, which poses do not move.
    """

    def __init__(self, parts: Sequence[PartFacts], cells: tuple[NDArray[np.bool_], Floats, Floats] | None) -> None:
        self._parts = [(part, np.array(part.vertices, dtype=np.float64).reshape(-1, 2)) for part in parts]
        self._cores = [_core(part.kind, points) for part, points in self._parts]
        self.is_map = any(part.kind == "cells" for part in parts)
        self._map = Placed("cells", _boxes(cells)) if self.is_map and cells is not None else None
        ends = [np.hypot(*points.T) if len(points) else np.zeros(1) for _, points in self._parts]
        circles = [math.hypot(*part.center) + part.radius for part in parts if part.kind == "circle"]
        self.reach = max([*circles, *(float(end.max()) for end in ends)], default=0.0)

    @property
    def is_known(self) -> bool:
        """Whether the record has the whole outline."""
        return not self.is_map or self._map is not None

    def at(self, pose: Sequence[float]) -> list[Placed]:
        """Its parts at a pose (x, y [m], heading [rad])."""
        if self._map is not None:
            return [self._map]
        x, y, heading = pose
        turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
        moved, placed = np.array([x, y]), []
        for (part, points), core in zip(self._parts, self._cores, strict=True):
            if part.kind == "circle":
                placed.append(Placed("circle", shapely.Point(np.array(part.center) @ turn + moved), part.radius))
                continue
            place = points @ turn + moved
            if part.kind == "polygon":
                inner = None if core is None else shapely.transform(core, lambda some: some @ turn + moved)
                placed.append(Placed("polygon", shapely.Polygon(place), core=inner))
            elif part.kind != "cells":
                line = shapely.LinearRing(place) if part.kind == "room" else shapely.LineString(place)
                placed.append(Placed(part.kind, line))
        return placed

    def box(self, pose: Sequence[float]) -> Floats:
        """Lower and upper corner of its bounding box at a pose (4,): x0, y0, x1, y1 [m]."""
        boxes = list[Floats]()
        for part in self.at(pose):
            whole = (
                shapely.box(*shapely.total_bounds(part.geometry.geometries)) if part.kind == "cells" else part.geometry
            )
            boxes.append(np.array(shapely.bounds(whole)) + np.array([-1, -1, 1, 1]) * part.radius)
        all_boxes = np.array(boxes or [np.full(4, np.nan)])
        return np.concatenate([all_boxes[:, :2].min(axis=0), all_boxes[:, 2:].max(axis=0)])


def _core(kind: str, points: Floats) -> Any:
    if kind != "polygon" or len(points) < 3:
        return None
    core = shapely.buffer(shapely.make_valid(shapely.Polygon(points)), -TOLERANCE_M, join_style="mitre")
    return None if core.is_empty else core


def _boxes(cells: tuple[NDArray[np.bool_], Floats, Floats]) -> Any:
    """A tree of boxes, each of the occupied cells that follow each other along x."""
    occupied, origin, cell = cells
    edges = np.diff(np.pad(occupied, ((1, 1), (0, 0))).astype(np.int8), axis=0)
    rows, begins = np.nonzero(edges.T == 1)
    _, ends = np.nonzero(edges.T == -1)
    x, y = origin
    low, high = x + begins * cell[0], x + ends * cell[0]
    return shapely.STRtree(shapely.box(low, y + rows * cell[1], high, y + (rows + 1) * cell[1]))


def gap(some: Sequence[Placed], others: Sequence[Placed]) -> float:
    """Distance between two bodies [m]: below 0 if circles overlap, 0 if other parts do; infinite without parts."""
    return min((_part_gap(a, b) for a in some for b in others), default=math.inf)


def _part_gap(a: Placed, b: Placed) -> float:
    if a.kind == "cells":
        a, b = b, a
    if b.kind == "cells":
        if a.kind == "cells" or not len(b.geometry):
            return math.inf
        _, distances = b.geometry.query_nearest(a.geometry, return_distance=True, all_matches=False)
        return float(distances[0]) - a.radius
    return float(shapely.distance(a.geometry, b.geometry)) - a.radius - b.radius


def overlap(some: Sequence[Placed], others: Sequence[Placed]) -> bool:
    """Whether two bodies overlap by more than :data:`TOLERANCE_M`, or a line crosses one of them."""
    return any(_overlaps(a, b) for a in some for b in others)


def _overlaps(a: Placed, b: Placed) -> bool:
    if a.kind == "cells":
        a, b = b, a
    if "circle" in (a.kind, b.kind):
        return _part_gap(a, b) < -TOLERANCE_M
    if b.kind == "cells":
        if a.kind == "cells":
            return False
        near = b.geometry.geometries.take(b.geometry.query(a.geometry, predicate="intersects"))
        inner = a.geometry if a.core is None and a.kind != "polygon" else a.core
        return inner is not None and any(
            shapely.intersects(shapely.buffer(box, -TOLERANCE_M, join_style="mitre"), a.geometry)
            or (a.kind == "polygon" and shapely.intersects(inner, box))
            for box in near
        )
    if a.core is not None or b.core is not None:
        return bool(
            (a.core is not None and shapely.intersects(a.core, b.geometry))
            or (b.core is not None and shapely.intersects(b.core, a.geometry))
        )
    return bool(shapely.crosses(a.geometry, b.geometry))


def signed_gap(some: Sequence[Placed], others: Sequence[Placed]) -> float:
    """Distance between two bodies [m], below 0 the depth of an overlap, NaN where that depth is not defined here.

    The depth of an overlap is how deep a corner of one outline, or a circle, lies in the other outline. A room is
    solid outside. Depths in a map are not computed.
    """
    return min((_signed(a, b) for a in some for b in others), default=math.inf)


def _signed(a: Placed, b: Placed) -> float:
    if a.kind == "circle":
        a, b = b, a
    distance = _part_gap(a, b)
    if a.kind == "cells" or b.kind == "cells" or a.kind == "circle":
        return distance
    if b.kind == "circle":
        inside = _in_solid(a, np.array(b.geometry.coords))[0]
        away = float(shapely.distance(_rim(a), b.geometry))
        return (-away if inside else away) - b.radius
    depths = [_depth(a, b), _depth(b, a)]
    known = [depth for depth in depths if depth is not None]
    return -max(known) if known else distance


def _depth(of: Placed, into: Placed) -> float | None:
    """Depth of the deepest corner of a part in another one; None if no corner lies in it."""
    corners = np.array(shapely.get_coordinates(of.geometry))
    inside = corners[_in_solid(into, corners)]
    return float(shapely.distance(_rim(into), shapely.points(inside)).max()) if len(inside) else None


def _rim(part: Placed) -> Any:
    return part.geometry.exterior if part.kind == "polygon" else part.geometry


def _in_solid(part: Placed, points: Floats) -> NDArray[np.bool_]:
    if part.kind not in ("polygon", "room"):
        return np.zeros(len(points), dtype=bool)
    area = part.geometry if part.kind == "polygon" else shapely.Polygon(part.geometry)
    inside: NDArray[np.bool_] = shapely.contains_xy(area, points)
    return inside if part.kind == "polygon" else ~shapely.intersects_xy(area, points)
