"""The areas that a drawing paints: of each paint its region, cut off by clip paths and covered by what came later."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import shapely

from irsim.bridges.maps.areas import filled, nested
from irsim.bridges.maps.source import Outlined
from irsim.common.arrays import Floats

__all__ = ["Clips", "painted_region", "visible"]

_CAPS: dict[str, Literal["flat", "round", "square"]] = {"butt": "flat", "round": "round", "square": "square"}
_JOINS: dict[str, Literal["mitre", "round", "bevel"]] = {"miter": "mitre", "round": "round", "bevel": "bevel"}


def painted_region(lines: list[Floats], rule: str, width: float = 0.0, cap: str = "butt", join: str = "miter") -> Any:
    """The area of paint [m].

    Args:
        lines: (K, 2) points of each line [m].
        rule: ``line`` for a line with a width, or how outlines are filled: ``evenodd`` or ``nonzero``.
        width: Width of a line [m].
        cap: Shape of its ends.
        join: Shape of its corners.
    """
    if rule == "evenodd":
        return nested([shapely.make_valid(shapely.Polygon(line)) for line in lines])
    if rule != "line":
        return filled(lines)
    walls = shapely.MultiLineString([line for line in lines if np.ptp(line, axis=0).any()])
    rings = [shapely.LinearRing(line) for line in lines if len(line) > 3 and (line[0] == line[-1]).all()]
    ends, corners = _CAPS.get(cap, "flat"), _JOINS.get(join, "mitre")
    parts = [walls, *rings]  # a closed line has no ends
    return shapely.union_all(shapely.buffer(parts, width / 2, cap_style=ends, join_style=corners, mitre_limit=4.0))


@dataclass
class Clips:
    """Clip paths where the drawing is right now: an element that is used twice is cut off at both places."""

    _regions: dict[str, list[Any]] = field(default_factory=dict)
    _used: set[str] = field(default_factory=set)

    def add(self, number: str, region: Any) -> None:
        """Add a shape to a clip path; after the path was used, the next shape starts another path."""
        if number in self._used:
            self._used.discard(number)
            self._regions.pop(number)
        self._regions.setdefault(number, []).append(region)

    def cut(self, numbers: list[str], region: Any) -> Any:
        """The part of an area that is inside of all these clip paths; one without shapes leaves nothing."""
        for number in numbers:
            shapes = self._regions.setdefault(number, [])
            self._used.add(number)
            if len(shapes) != 1:
                shapes[:] = [shapely.union_all(shapes)]
            region = region.intersection(shapes[0])
        return region


def visible(regions: list[Any], dark: Any, names: list[str]) -> list[Outlined]:
    """The parts of dark paint that light paint, which came later, leaves visible.

    Args:
        regions: Areas in the order in which they are painted.
        dark: (N,) whether each is dark.
        names: Their names.
    """
    light = np.flatnonzero(~dark)
    tree = shapely.STRtree([regions[k] for k in light])
    things = []
    for number in np.flatnonzero(dark):
        above = light[tree.query(regions[number], predicate="intersects")]
        above = above[above > number]
        region = regions[number]
        if len(above):
            region = region.difference(shapely.union_all([regions[k] for k in above]))
        if region.area > 0:
            things.append(Outlined(names[number], region))
    return things
