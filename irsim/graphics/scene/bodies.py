"""Shapes of objects in the body frame, and their transformation to a pose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common import outline as outlines
from irsim.common.outline import outline
from irsim.graphics.scene.scene import Circle, Geometry, Line, Picture, Region, Sector, Segments, Spots

if TYPE_CHECKING:
    from irsim._core import State

__all__ = [
    "Body",
    "Pose",
    "area_of",
    "arrow",
    "bounds",
    "box",
    "ellipse",
    "geometry_of",
    "picture_outline",
    "place",
    "point_on",
    "read_body",
]

Pose = tuple[float, float, float]
"""x, y [m] and heading [rad]."""

_SHAFT_HALF_WIDTH = 0.1
"""Half the width of the shaft of an arrow, as a share of the width given."""
_HEAD_HALF_WIDTH = 0.3
"""Half the width of the head of an arrow, as a share of the width given."""
_SHAFT_LENGTH = 0.6
"""Length of the shaft, as a share of the length of the arrow."""
_KINDS = {outlines.Circle: "circle", outlines.Polygon: "polygon", outlines.Line: "linestring", outlines.Cells: "cells"}
_ELLIPSE_POINTS = 64
_SEGMENTS_PER_QUARTER = 32
"""Number of segments that stand for a quarter circle where shapes are united."""


@dataclass(slots=True)
class Body:
    """Shape of an object in its own frame.

    Attributes:
        kind: ``circle``, ``polygon``, ``linestring`` or ``compound``.
        geometry: The shape; for a compound, the union of its parts.
        low, high: Corners of the bounding box [m].
        radius: Radius of the bounding circle [m].
    """

    kind: str
    geometry: Geometry
    low: tuple[float, float]
    high: tuple[float, float]
    radius: float

    @property
    def length(self) -> float:
        """Extent along body x [m]."""
        return self.high[0] - self.low[0]

    @property
    def width(self) -> float:
        """Extent along body y [m]."""
        return self.high[1] - self.low[1]

    @property
    def middle(self) -> tuple[float, float]:
        """Centre of the bounding box."""
        return (self.low[0] + self.high[0]) / 2, (self.low[1] + self.high[1]) / 2


def read_body(state: State, row: int) -> Body:
    """Read the shape of the object in one row of the simulation."""
    result = outline(state, row)
    kind = _KINDS[type(result.parts[0])] if len(result.parts) == 1 else "compound"
    (left, bottom), (right, top) = (corner.tolist() for corner in result.box())
    return Body(kind, geometry_of(result.parts), (left, bottom), (right, top), float(state.radius[row]))


def geometry_of(parts: Sequence[outlines.Part]) -> Geometry:
    """Return the parts of a body as one geometry: the only one, or the union of several.

    A union has one outline where parts overlap, so that a translucent compound has no darker places.
    """
    if len(parts) == 1:
        return _geometry_of(parts[0])
    return _region_of(outlines.Outline(parts).shapely(_SEGMENTS_PER_QUARTER))


def place(geometry: Geometry, pose: Pose) -> Geometry:
    """Transform a geometry from the body frame to a pose."""
    x, y, theta = pose
    c, s = math.cos(theta), math.sin(theta)
    if isinstance(geometry, Circle):
        return Circle(x + c * geometry.x - s * geometry.y, y + s * geometry.x + c * geometry.y, geometry.radius)
    turn = np.array([[c, s], [-s, c]])
    if isinstance(geometry, Region):
        return Region([ring @ turn + (x, y) for ring in geometry.rings])
    if isinstance(geometry, Line):
        return Line(geometry.points @ turn + (x, y))
    raise TypeError(f"a body must consist of circles, regions and lines, got a {type(geometry).__name__}")


def _geometry_of(part: outlines.Part) -> Geometry:
    if isinstance(part, outlines.Circle):
        return Circle(*part.center, part.radius)
    if isinstance(part, outlines.Polygon):
        return Region([part.corners])
    return Line(part.path if isinstance(part, outlines.Line) else part.points)


def arrow(length: float, width: float) -> Region:
    """Make an arrow along body x that starts at the origin; its head is 0.6 ``width`` wide [m]."""
    shaft, head, neck = _SHAFT_HALF_WIDTH * width, _HEAD_HALF_WIDTH * width, _SHAFT_LENGTH * length
    outline = [(0, -shaft), (neck, -shaft), (neck, -head), (length, 0), (neck, head), (neck, shaft), (0, shaft)]
    return Region([np.array(outline, dtype=np.float64)])


def box(body: Body) -> Region:
    """Return the bounding box of a body as a region."""
    (x0, y0), (x1, y1) = body.low, body.high
    return Region([np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], dtype=np.float64)])


def ellipse(body: Body) -> Region:
    """Return the ellipse inscribed in the bounding box of a body."""
    angles = np.linspace(0, 2 * math.pi, _ELLIPSE_POINTS, endpoint=False)
    (x, y), rx, ry = body.middle, body.length / 2, body.width / 2
    return Region([np.stack([x + rx * np.cos(angles), y + ry * np.sin(angles)], axis=1)])


def picture_outline(picture: Picture) -> Geometry:
    """Return the rectangle that an image covers."""
    x, y, length, width = picture.box
    corners = [(x, y), (x + length, y), (x + length, y + width), (x, y + width)]
    return place(Region([np.array(corners, dtype=np.float64)]), picture.pose)


def bounds(geometry: Geometry) -> tuple[float, float, float, float]:
    """Return left, bottom, right and top of a geometry [m]."""
    if isinstance(geometry, Circle | Sector):
        x, y, r = geometry.x, geometry.y, geometry.radius
        return x - r, y - r, x + r, y + r
    if isinstance(geometry, Region):
        points = geometry.rings[0] if len(geometry.rings) == 1 else np.concatenate(geometry.rings)
    else:
        points = geometry.points.reshape(-1, 2)
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    reach = geometry.radius if isinstance(geometry, Spots) else 0.0
    return float(x0 - reach), float(y0 - reach), float(x1 + reach), float(y1 + reach)


def point_on(geometry: Geometry, view: tuple[float, float, float, float] | None = None) -> tuple[float, float] | None:
    """Return a point of a geometry that a label can stand at.

    Args:
        geometry: The geometry; a line has its point in the middle of its longest segment, other shapes on their upper
            edge.
        view: Left, bottom, right and top of the part of the world that is seen [m]; default: everything.

    Returns:
        The point; None if nothing of the geometry is seen.
    """
    import shapely

    shape: Any
    if isinstance(geometry, Circle | Sector):
        shape = shapely.Point(geometry.x, geometry.y).buffer(geometry.radius)
    elif isinstance(geometry, Spots):
        shape = shapely.MultiPoint(geometry.points).buffer(geometry.radius)
    elif isinstance(geometry, Segments):
        shape = shapely.MultiLineString(list(geometry.points))
    elif isinstance(geometry, Line):
        shape = shapely.MultiLineString(list(zip(geometry.points[:-1], geometry.points[1:], strict=True)))
    else:
        shape = area_of(geometry)
    seen = shape if view is None else shape.intersection(shapely.box(*view))
    pieces = [piece for piece in getattr(seen, "geoms", [seen]) if not piece.is_empty]
    if not pieces:
        return None
    if isinstance(geometry, Line | Segments):
        middle = max(pieces, key=lambda piece: piece.length).interpolate(0.5, normalized=True)
        return float(middle.x), float(middle.y)
    piece = max(pieces, key=lambda piece: piece.area)
    inside = piece.representative_point()
    column = piece.intersection(shapely.LineString([(inside.x, inside.y), (inside.x, piece.bounds[3])]))
    lowest = min(getattr(column, "geoms", [column]), key=lambda part: part.bounds[1])
    return float(inside.x), float(lowest.bounds[3])


def area_of(region: Region) -> Any:
    """Return a region as a shapely geometry; its outlines run counter-clockwise, its holes clockwise."""
    import shapely

    rings = [shapely.LinearRing(ring) for ring in region.rings]
    outlines = [shapely.Polygon(ring) for ring in rings if ring.is_ccw or len(rings) == 1]
    holes = [shapely.Polygon(ring) for ring in rings if not ring.is_ccw and len(rings) > 1]
    return shapely.difference(shapely.union_all(outlines), shapely.union_all(holes))


def _region_of(area: Any) -> Region:
    """Return a polygon of shapely, or several, as a region."""
    import shapely

    areas = shapely.get_parts(shapely.orient_polygons(area))
    rings = [ring for polygon in areas for ring in (polygon.exterior, *polygon.interiors)]
    return Region([np.asarray(ring.coords)[:-1] for ring in rings])
