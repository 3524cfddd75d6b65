"""``stadium``: a rectangle with round ends, the outline of many carts."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import ShapeOptions
from irsim.options.registry import SHAPES
from irsim.options.units import Meters


class Stadium(ShapeOptions):
    """A rectangle with a half disc at the front and one at the back."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "stadium", "length": 1.0, "width": 0.4}]}

    name: Literal["stadium"] = "stadium"
    length: Annotated[Meters, Field(gt=0)] = 1.0
    """Length of the straight sides, along the heading; the round ends add to it."""
    width: Annotated[Meters, Field(gt=0)] = 0.4
    """Width across the heading; the radius of the round ends is half of it."""


@SHAPES.register(Stadium)
def parts(options: Stadium) -> list[core.Part]:
    """Return the geometry for the core, in the body frame with the origin in the middle."""
    x, y = options.length / 2, options.width / 2
    return [
        core.Polygon(vertices=[[-x, -y], [x, -y], [x, y], [-x, y]]),
        core.Circle(radius=y, center=[x, 0.0]),
        core.Circle(radius=y, center=[-x, 0.0]),
    ]
