"""Zones: lines and areas of the world that are watched, under ``world.zones``."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from irsim.options.base import Options
from irsim.options.colors import Color
from irsim.options.regions import OUTLINE_ALIASES, Corners, Points, Rectangle, rectangle_corners
from irsim.options.units import Meters
from irsim.options.vectors import Point

__all__ = ["OUTLINES", "Disc", "Zone"]

OUTLINES = ("line", "polygon", "rectangle", "circle")
"""Keys that say where a zone is; each zone has exactly one of them."""


class Disc(Options):
    """A disc of the world."""

    center: Point
    """Centre: [x, y]."""
    radius: Annotated[Meters, Field(gt=0)]
    """Radius of the disc."""


class Zone(Options):
    """A line that objects cross, or an area that they enter. It is neither solid nor seen by sensors.

    Give exactly one of `line`, `polygon`, `rectangle` and `circle`, in world coordinates.
    """

    also_called: ClassVar[dict[str, str]] = {
        **OUTLINE_ALIASES,
        "gate": "line",
        "segment": "line",
        "points": "line",
        "region": "rectangle",
        "disc": "circle",
    }
    schema_extra: ClassVar[dict[str, Any]] = {
        "oneOf": [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in OUTLINES],
        "examples": [
            {"name": "door", "line": [[5, 4], [5, 6]]},
            {"name": "kitchen", "rectangle": [6, 1, 9, 4]},
            {"name": "stairs", "polygon": [[1, 7], [3, 7], [2, 9]]},
            {"name": "dock", "circle": {"center": [8, 8], "radius": 0.5}},
        ],
    }

    name: Annotated[str, Field(strict=True, min_length=1)]
    """Unique name of the zone, which events and metrics use."""
    line: Annotated[Points, Field(min_length=2, max_length=2)] | None = None
    """A line from one point to another: [[x, y], [x, y]]. An object crosses it when its centre does; left and right
    are as seen from the first point towards the second."""
    polygon: Corners | None = None
    """An area: its corners in order, [[x, y], [x, y], ...]. An object is inside as long as its body touches the
    area."""
    rectangle: Rectangle | None = None
    """An area: [x_min, y_min, x_max, y_max]."""
    circle: Disc | None = None
    """An area: a disc with `center` and `radius`."""
    color: Color | None = None
    """Colour of the zone in pictures; null is one colour for all zones. `world.plot.show_zones` draws them."""

    @property
    def is_line(self) -> bool:
        """Whether the zone is a line, not an area."""
        return self.line is not None

    @property
    def points(self) -> list[list[float]]:
        """The two ends of a line, or the corners of a polygon or rectangle [m]; empty for a disc."""
        if self.rectangle is not None:
            return rectangle_corners(self.rectangle)
        return self.line or self.polygon or []

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max of the zone [m]."""
        if self.circle is not None:
            (x, y), r = self.circle.center, self.circle.radius
            return x - r, y - r, x + r, y + r
        xs, ys = [point[0] for point in self.points], [point[1] for point in self.points]
        return min(xs), min(ys), max(xs), max(ys)
