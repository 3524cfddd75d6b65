"""``compound``: several parts that move as one."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import ShapeOptions, random_polygon
from irsim.components.shapes.circle import Circle
from irsim.components.shapes.polygon import SQUARE, Polygon
from irsim.components.shapes.rectangle import Rectangle, corners
from irsim.options.registry import SHAPES
from irsim.options.selection import Choices, Select
from irsim.options.vectors import Offset


class CirclePart(Circle):
    """A disc of a compound."""

    pose: Offset = [0.0, 0.0, 0.0]
    """Pose of the part in the body frame: [x, y, theta]."""


class RectanglePart(Rectangle):
    """A box of a compound."""

    pose: Offset = [0.0, 0.0, 0.0]
    """Pose of the part in the body frame: [x, y, theta]."""


class PolygonPart(Polygon):
    """An outline of a compound."""

    pose: Offset = [0.0, 0.0, 0.0]
    """Pose of the part in the body frame: [x, y, theta]."""


_PARTS: dict[str, type[CirclePart] | type[RectanglePart] | type[PolygonPart]] = {
    "circle": CirclePart,
    "rectangle": RectanglePart,
    "polygon": PolygonPart,
}
Part = Annotated[Any, Select(Choices("shape", _PARTS), folded=True)]


class Compound(ShapeOptions):
    """The union of circles, rectangles and polygons, fixed to one body. Parts that touch are one wall."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {
                "name": "compound",
                "parts": [
                    {"name": "rectangle", "length": 1.0, "width": 0.4},
                    {"name": "circle", "radius": 0.3, "pose": [0.5, 0, 0]},
                ],
            }
        ]
    }

    name: Literal["compound"] = "compound"
    parts: Annotated[list[Part], Field(min_length=1)]
    """Parts of the shape: mappings like a `shape` (circle, rectangle or polygon), each with a `pose` in the body
    frame."""


def _transform(points: list[list[float]], pose: list[float]) -> list[list[float]]:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return [[pose[0] + c * x - s * y, pose[1] + s * x + c * y] for x, y in points]


def _part(part: CirclePart | RectanglePart | PolygonPart) -> core.Part:
    if isinstance(part, CirclePart):
        offset = [part.center[0] + (part.wheelbase or 0.0) / 2, part.center[1]]
        center = _transform([offset], part.pose)[0]
        if part.random_shape:
            return core.RandomCircle(radius_range=part.radius_range, center=center)
        return core.Circle(radius=part.radius, center=center)
    if isinstance(part, RectanglePart):
        return core.Polygon(vertices=_transform(corners(part), part.pose))
    if part.random_shape:  # the checks refuse a pose here: the core draws it in the body frame
        return random_polygon(part, part.is_convex, closed=True)
    return core.Polygon(vertices=_transform(part.vertices or SQUARE, part.pose))


@SHAPES.register(Compound)
def parts(options: Compound) -> list[core.Part]:
    """Geometry for the core, body frame."""
    return [_part(part) for part in options.parts]
