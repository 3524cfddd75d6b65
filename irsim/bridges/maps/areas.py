"""Areas from outlines that a drawing fills: by the rule of even and odd, or by how often they are gone around.

The process that reads a plan unites its areas, within its limits of memory and time, and hands them over as bytes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely

from irsim.bridges.maps.apart import Refused
from irsim.bridges.maps.source import Outlined, Outlines
from irsim.common.arrays import Floats

__all__ = ["filled", "nested", "packed", "unpacked"]

_MOST_PAIRS = 50_000_000
"""Pairs of a face and a corner that are looked at."""

_MOST_CORNERS = 5_000_000
"""Corners of all areas, and of what they cover together."""


def packed(things: list[Outlined]) -> tuple[Any, dict[str, Any]]:
    """Areas, and the one that they cover together, as bytes, and what tells them apart as JSON.

    Raises:
        Refused: They cross so often that there are too many corners.
    """
    regions = [thing.region for thing in things]
    regions.append(shapely.union_all(regions))
    if shapely.get_num_coordinates(regions).sum() > _MOST_CORNERS:
        what = f"its areas cross so often that they have more than {_MOST_CORNERS:,} corners"
        raise Refused(what, "leave out layers that are not walls, such as hatches of lines")
    texts = list(shapely.to_wkb(regions))
    answer = {"sizes": [len(text) for text in texts], "names": [thing.name for thing in things]}
    return np.frombuffer(b"".join(texts), dtype=np.uint8), answer


def unpacked(data: Any, said: dict[str, Any]) -> Outlines:
    """The outlines that :func:`packed` has made bytes of, with their unit and remarks."""
    content, ends = data.tobytes(), np.cumsum(said["sizes"])
    texts = [content[end - size : end] for size, end in zip(said["sizes"], ends, strict=True)]
    *regions, solid = shapely.from_wkb(np.array(texts, dtype=object))
    things = [Outlined(name, region) for name, region in zip(said["names"], regions, strict=True)]
    return Outlines(things, solid=solid, meters_per_unit=float(said["unit"]), notes=list(said["notes"]))


def nested(regions: list[Any]) -> Any:
    """The area within an odd number of regions, in pairs, so that many regions take little time."""
    while len(regions) > 1:
        pairs = zip(regions[::2], regions[1::2], strict=False)
        regions = [one.symmetric_difference(other) for one, other in pairs] + regions[len(regions) // 2 * 2 :]
    return regions[0]


def filled(lines: list[Floats]) -> Any:
    """The area that closed lines go around, once more in one direction than in the other; ends are joined.

    Args:
        lines: (K, 2) points of each line, at least three.
    """
    rings = [np.concatenate([line, line[:1]]) for line in lines]
    if len(rings) == 1:
        simple = shapely.Polygon(rings[0])
        if simple.is_valid:
            return simple
    faces = shapely.get_parts(shapely.polygonize([shapely.union_all(shapely.MultiLineString(rings))]))
    if not len(faces):
        return shapely.Polygon()
    if len(faces) * sum(map(len, rings)) > _MOST_PAIRS:
        return nested([shapely.make_valid(shapely.Polygon(ring)) for ring in rings])
    inside = shapely.get_coordinates(shapely.point_on_surface(faces))
    turns = sum(_turns(ring, inside) for ring in rings)
    return shapely.union_all(faces[turns != 0])


def _turns(ring: Floats, points: Floats) -> Any:
    """(P,) how often a closed line goes counterclockwise around points."""
    start, end = ring[:-1], ring[1:]
    result = np.zeros(len(points), np.int64)
    for number, (x, y) in enumerate(points):
        up, down = (start[:, 1] <= y) & (end[:, 1] > y), (start[:, 1] > y) & (end[:, 1] <= y)
        side = (end[:, 0] - start[:, 0]) * (y - start[:, 1]) - (x - start[:, 0]) * (end[:, 1] - start[:, 1])
        result[number] = (up & (side > 0)).sum() - (down & (side < 0)).sum()
    return result
