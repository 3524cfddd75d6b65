"""``circle``: a disc."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import ShapeOptions
from irsim.options.registry import SHAPES
from irsim.options.units import Bool, Meters
from irsim.options.vectors import Point, vector


class Circle(ShapeOptions):
    """A disc."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "circle", "radius": 0.3}]}

    name: Literal["circle"] = "circle"
    radius: Annotated[Meters, Field(gt=0)] = 0.2
    """Radius of the disc."""
    center: Point = [0.0, 0.0]
    """Offset of the middle of the disc in the body frame; it turns with the heading."""
    random_shape: Bool = False
    """Draw a random radius for every scene instead; with `number`, each object has its own."""
    radius_range: Annotated[list[Annotated[Meters, Field(gt=0)]], vector(("m", "m"), 2)] = [0.1, 1.0]
    """Range of the random radius, with `random_shape`."""


@SHAPES.register(Circle)
def parts(options: Circle) -> list[core.Part]:
    """Geometry for the core, body frame."""
    center = [options.center[0] + (options.wheelbase or 0.0) / 2, options.center[1]]
    if options.random_shape:
        return [core.RandomCircle(radius_range=options.radius_range, center=center)]
    return [core.Circle(radius=options.radius, center=center)]
