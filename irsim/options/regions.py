"""Areas of the world, given as a polygon or a rectangle."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field

from irsim.options.base import Options, problem
from irsim.options.vectors import Component, Point, is_vector, vector

__all__ = ["OUTLINES", "OUTLINE_ALIASES", "Corners", "Points", "Rectangle", "Region", "rectangle_corners"]

OUTLINES = ("polygon", "rectangle")
"""Keys that say where a region is; each region has exactly one of them."""
OUTLINE_ALIASES = {
    "vertices": "polygon",
    "corners": "polygon",
    "outline": "polygon",
    "box": "rectangle",
    "rect": "rectangle",
}
"""Other names of these keys, in regions and in other areas."""


def _check_points(value: Any) -> Any:
    """Refuse flat coordinates, which would give one error per number."""
    if not (is_vector(value) and value):
        return value
    pairs = [list(value[start : start + 2]) for start in range(0, len(value), 2)] if len(value) % 2 == 0 else None
    raise problem(
        "wrong-type",
        "points must be written as [[x, y], [x, y], ...]",
        allowed="a list of points [x, y]",
        fix="put brackets around each point",
        replace=pairs,
    )


Points = Annotated[list[Point], BeforeValidator(_check_points)]
Corners = Annotated[Points, Field(min_length=3)]
Rectangle = Annotated[list[Component], vector(("m", "m", "m", "m"), 4)]


def rectangle_corners(rectangle: list[float]) -> list[list[float]]:
    """Return the corners of a rectangle [x_min, y_min, x_max, y_max], counterclockwise."""
    x0, y0, x1, y1 = rectangle
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


class Region(Options):
    """An area of the world. Give either `polygon` or `rectangle`."""

    also_called: ClassVar[dict[str, str]] = {**OUTLINE_ALIASES, "points": "polygon"}
    schema_extra: ClassVar[dict[str, Any]] = {
        "oneOf": [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in OUTLINES],
        "examples": [{"rectangle": [0, 4, 10, 6]}, {"polygon": [[0, 0], [6, 0], [6, 3], [0, 3]]}],
    }

    polygon: Corners | None = None
    """Its corners in order, [[x, y], [x, y], ...]."""
    rectangle: Rectangle | None = None
    """[x_min, y_min, x_max, y_max]."""

    @property
    def points(self) -> list[list[float]]:
        """The corners [m]."""
        return rectangle_corners(self.rectangle) if self.rectangle is not None else self.polygon or []
