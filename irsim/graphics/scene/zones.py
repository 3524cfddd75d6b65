"""Marks and names of zones, the lines and areas of ``world.zones``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Circle, Geometry, Label, Line, Mark, Region, Stroke
from irsim.graphics.scene.style import Color

if TYPE_CHECKING:
    from irsim.graphics.scene.scene import Scene
    from irsim.scenario.model.zones import Zone

__all__ = ["DrawnZones", "draw_zones"]

_LINE_WIDTH_PT = 2.0
_EDGE_WIDTH_PT = 1.0
_FILL_ALPHA = 0.13
_ALPHA = 0.85
_ZORDER = 0.4
_TEXT_SIZE_PT = 8.0
_TEXT_ZORDER = 9.0
_POINTER_SHARE = 0.02
"""Size of the pointer of a line, as a share of the longer side of the picture."""
_MAX_POINTER_SHARE = 0.25
"""Greatest size of that pointer, as a share of the length of the line."""
_GAP_SHARE = 0.005
"""Distance between a zone and its name, as a share of the height of the picture."""


@dataclass(frozen=True)
class DrawnZones:
    """Marks and labels of zones; the identical objects in every scene, so that a figure need not update them."""

    marks: list[Mark]
    labels: list[Label]

    def add_to(self, scene: Scene) -> None:
        """Add them to a scene."""
        scene.marks += self.marks
        scene.labels += self.labels


def draw_zones(zones: Sequence[Zone], color: Color, extent: tuple[float, float, float, float]) -> DrawnZones:
    """Draw zones: areas filled pale with a dashed edge, lines with a pointer from left to right.

    Args:
        zones: The zones.
        color: Colour of the zones that have none of their own.
        extent: Part of the world that the picture shows: x from, x to, y from, y to [m].
    """
    drawn = DrawnZones([], [])
    for index, zone in enumerate(zones):
        number, own = -1 - index, color if zone.color is None else zone.color
        if zone.is_line:
            ends = np.array(zone.points, dtype=np.float64)
            shape: Geometry = Line(ends)
            drawn.marks.append(Mark(number, "zone", shape, None, Stroke(own, _LINE_WIDTH_PT), _ALPHA, _ZORDER))
            pointer = _pointer(ends, _POINTER_SHARE * max(extent[1] - extent[0], extent[3] - extent[2]))
            drawn.marks.append(Mark(number, "zone", pointer, own, Stroke(None), _ALPHA, _ZORDER))
        else:
            shape = _area(zone)
            edge = Stroke(own, _EDGE_WIDTH_PT, style="--")
            drawn.marks.append(Mark(number, "zone", shape, own, Stroke(None), _FILL_ALPHA, _ZORDER))
            drawn.marks.append(Mark(number, "zone", shape, None, edge, _ALPHA, _ZORDER))
        drawn.labels.append(_label(number, zone.title, shape, own, extent))
    return drawn


def _area(zone: Zone) -> Circle | Region:
    if zone.circle is None:
        return Region([_ring(zone.points)])
    x, y = zone.circle.center
    return Circle(x, y, zone.circle.radius)


def _ring(points: Sequence[Sequence[float]]) -> Floats:
    """The corners of a polygon in counter-clockwise order."""
    ring = np.array(points, dtype=np.float64)
    x, y = ring.T
    return ring if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) >= 0 else ring[::-1]


def _pointer(ends: Floats, size: float) -> Region:
    """A triangle at the middle of a line that points to its right."""
    along = ends[1] - ends[0]
    length = math.hypot(*along)
    size = min(size, _MAX_POINTER_SHARE * length)
    along = along / length * size
    right, middle = np.array([along[1], -along[0]]), ends.mean(axis=0)
    return Region([np.array([middle - along / 2, middle + right, middle + along / 2])])


def _label(number: int, name: str, shape: Geometry, color: Color, extent: tuple[float, float, float, float]) -> Label:
    """The name of a zone above the part of it that the picture shows."""
    left, bottom, right, top = bounds(shape)
    x0, x1, y0, y1 = extent
    if left <= x1 and right >= x0 and bottom <= y1 and top >= y0:
        left, right, bottom, top = max(left, x0), min(right, x1), max(bottom, y0), min(top, y1)
    anchor = (left + right) / 2, (bottom + top) / 2
    y = top + _GAP_SHARE * (y1 - y0)
    return Label(number, "zone", left, y, anchor, name, color, _TEXT_SIZE_PT, 1.0, _TEXT_ZORDER)
