"""``rectangle``: a box."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import ShapeOptions
from irsim.options.registry import SHAPES
from irsim.options.units import Meters


class Rectangle(ShapeOptions):
    """A box along the heading, centred on the position; with `wheelbase` the position is the rear axle."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "rectangle", "length": 4.6, "width": 1.8, "wheelbase": 3.0}]
    }

    name: Literal["rectangle"] = "rectangle"
    length: Annotated[Meters, Field(gt=0)] = 1.0
    """Extent along the heading."""
    width: Annotated[Meters, Field(gt=0)] = 1.0
    """Extent across the heading."""


def corners(options: Rectangle) -> list[list[float]]:
    """The four corners, counter-clockwise from the rear right, body frame [m]."""
    # with a wheelbase the overhang behind the rear axle is half of what the axles leave over
    rear = -options.length / 2 if options.wheelbase is None else -(options.length - options.wheelbase) / 2
    front, half = rear + options.length, options.width / 2
    return [[rear, -half], [front, -half], [front, half], [rear, half]]


@SHAPES.register(Rectangle)
def parts(options: Rectangle) -> list[core.Part]:
    """Geometry for the core, body frame."""
    return [core.Polygon(vertices=corners(options))]
