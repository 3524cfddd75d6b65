"""Checks the outlines of areas of the world that are written as a rectangle or as a polygon."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.messages.findings import Finding, error
from irsim.scenario.yaml.formatting import flow

__all__ = ["check_polygon", "check_rectangle", "crosses_itself", "distinct_corners", "repair_outline", "segment_gap"]


def check_rectangle(path: Path, rectangle: Sequence[float]) -> Iterator[Finding]:
    """Report a rectangle without an area, or with its bounds in the wrong order."""
    x0, y0, x1, y1 = rectangle
    if x0 < x1 and y0 < y1:
        return
    ordered = [min(x0, x1), min(y0, y1), max(x0, x1), max(y0, y1)]
    turned = ordered[0] < ordered[2] and ordered[1] < ordered[3]
    yield error(
        "range-order",
        path,
        "a rectangle is [x_min, y_min, x_max, y_max], with each minimum below its maximum",
        given=rectangle,
        fix=f"rectangle: {flow(ordered)}" if turned else None,
        edit=Edit("replace", path, ordered) if turned else None,
    )


def check_polygon(path: Path, vertices: Sequence[Sequence[float]]) -> Iterator[Finding]:
    """Report a polygon with too few corners, or one that crosses itself."""
    corners = distinct_corners(vertices)
    if len(corners) < 3:
        message = f"a polygon must have at least 3 different corners, got {len(corners)}"
        yield error("too-few-vertices", path, message, given=vertices)
        return
    if not crosses_itself(corners):
        return
    areas = repair_outline(vertices)
    if areas is None:
        yield error("invalid-polygon", path, "this outline encloses no area", given=vertices)
        return
    single = len(areas) == 1
    yield error(
        "invalid-polygon",
        path,
        "this outline crosses or touches itself",
        given=vertices,
        allowed="corners in order around the polygon",
        fix=f"polygon: {flow(areas[0])}" if single else "write one for each area that it encloses",
        edit=Edit("replace", path, areas[0]) if single else None,
    )


Corner = tuple[float, float]
_MIN_AREA = 1e-12
"""Outlines with a smaller area enclose none [m^2]."""
_MAX_SWEEP_CORNERS = 200
"""Corners up to which the sweep is faster than loading the geometry library."""


def distinct_corners(vertices: Sequence[Sequence[float]]) -> list[Corner]:
    """The corners without repeated neighbours, and without the first corner repeated at the end."""
    corners: list[Corner] = []
    for x, y in vertices:
        if not corners or corners[-1] != (x, y):
            corners.append((x, y))
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    return corners


def crosses_itself(corners: Sequence[Corner]) -> bool:
    """Whether the closed outline crosses or touches itself, or encloses no area.

    Args:
        corners: At least 3 corners; the first is not repeated at the end.
    """
    n = len(corners)
    if n > _MAX_SWEEP_CORNERS:
        from shapely import Polygon

        return not Polygon(corners).is_valid
    area = sum(corners[i - 1][0] * corners[i][1] - corners[i][0] * corners[i - 1][1] for i in range(n)) / 2
    if abs(area) < _MIN_AREA:
        return True
    edges = [(corners[i], corners[(i + 1) % n]) for i in range(n)]
    order = sorted(range(n), key=lambda i: min(edges[i][0][0], edges[i][1][0]))
    active: list[int] = []
    for i in order:  # sweep along x: only edges whose x ranges overlap are compared
        left = min(edges[i][0][0], edges[i][1][0])
        active = [j for j in active if max(edges[j][0][0], edges[j][1][0]) >= left]
        for j in active:
            first, second = min(i, j), max(i, j)
            if second - first == 1 or (first == 0 and second == n - 1):
                if _folds_back(edges[first], edges[second]):
                    return True
            elif _meet(*edges[i], *edges[j]):
                return True
        active.append(i)
    return False


def repair_outline(vertices: Sequence[Sequence[float]]) -> list[list[list[float]]] | None:
    """The area that an invalid outline encloses, as valid polygons; None if it encloses none."""
    import numpy as np
    from shapely import MultiPolygon, Polygon, make_valid
    from shapely.errors import GEOSException

    with np.errstate(all="ignore"):  # coordinates may be huge
        try:
            valid = make_valid(Polygon(vertices), method="structure", keep_collapsed=False)
        except (GEOSException, ValueError):
            return None
        pieces = [valid] if isinstance(valid, Polygon) else list(valid.geoms) if isinstance(valid, MultiPolygon) else []
        polygons = [polygon for polygon in sorted(pieces, key=lambda p: p.bounds) if polygon.area > _MIN_AREA]
    outlines = [[[float(x), float(y)] for x, y in polygon.exterior.coords[:-1]] for polygon in polygons]
    return outlines or None


def segment_gap(first: tuple[Corner, Corner], second: tuple[Corner, Corner]) -> float:
    """Distance between two segments [m]."""
    (a, b), (c, d) = first, second
    if _meet(a, b, c, d):
        return 0.0
    return min(_gap(c, a, b), _gap(d, a, b), _gap(a, c, d), _gap(b, c, d))


def _gap(p: Corner, a: Corner, b: Corner) -> float:
    """Distance from a point to a segment [m]."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = dx * dx + dy * dy
    t = min(1.0, max(0.0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length)) if length > 0 else 0.0
    return math.hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy)


def _side(a: Corner, b: Corner, p: Corner) -> float:
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])


def _within(a: Corner, b: Corner, p: Corner) -> bool:
    return min(a[0], b[0]) <= p[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= p[1] <= max(a[1], b[1])


def _meet(a: Corner, b: Corner, c: Corner, d: Corner) -> bool:
    """Whether the closed segments ab and cd have a point in common."""
    if max(a[1], b[1]) < min(c[1], d[1]) or max(c[1], d[1]) < min(a[1], b[1]):
        return False
    abc, abd, cda, cdb = _side(a, b, c), _side(a, b, d), _side(c, d, a), _side(c, d, b)
    if ((abc > 0) != (abd > 0)) and ((cda > 0) != (cdb > 0)) and 0 not in (abc, abd, cda, cdb):
        return True
    return (
        (abc == 0 and _within(a, b, c))
        or (abd == 0 and _within(a, b, d))
        or (cda == 0 and _within(c, d, a))
        or (cdb == 0 and _within(c, d, b))
    )


def _folds_back(first: tuple[Corner, Corner], second: tuple[Corner, Corner]) -> bool:
    """Whether two edges that share a corner run over each other."""
    (a, b), (c, d) = first, second
    shared, p, q = (b, a, d) if b == c else (a, b, c)
    if _side(shared, p, q) != 0:
        return False
    return (p[0] - shared[0]) * (q[0] - shared[0]) + (p[1] - shared[1]) * (q[1] - shared[1]) > 0
