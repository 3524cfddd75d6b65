"""Options that all shapes have in common, and the parameters of random outlines."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

import irsim._core as core
from irsim.options.base import Options
from irsim.options.units import Bool, Integer, Meters
from irsim.options.vectors import Component, Point, vector

__all__ = ["RandomOutline", "ShapeOptions", "random_polygon"]


class ShapeOptions(Options):
    """A footprint in the body frame: the origin is the object's position, +x its heading."""

    any_case: ClassVar[bool] = True

    name: str
    """Name of the shape."""
    wheelbase: Annotated[Meters, Field(ge=0)] | None = None
    """Distance between the axles, for `acker`; rectangles and circles then have their origin at the rear axle."""


class RandomOutline(ShapeOptions):
    """Parameters of randomly drawn vertices."""

    vertices: list[Point] | None = None
    """Corners in the body frame, used as given; the object's `state` moves and turns them."""
    random_shape: Bool = False
    """Draw random vertices for every scene instead; with `number`, each object has its own."""
    center_range: Annotated[list[Component], vector(("m", "m", "m", "m"), 4)] = [0.0, 0.0, 0.0, 0.0]
    """Range of the middle of a random outline, body frame: [xmin, ymin, xmax, ymax]."""
    avg_radius_range: Annotated[list[Annotated[Component, Field(ge=0)]], vector(("m", "m"), 2)] = [0.1, 1.0]
    """Range of the mean distance of the vertices from the middle."""
    irregularity_range: Annotated[list[Annotated[Component, Field(ge=0, le=1)]], vector(("1", "1"), 2)] = [0.0, 1.0]
    """Range of the unevenness of the angles between vertices: 0 is even, 1 very uneven."""
    spikeyness_range: Annotated[list[Annotated[Component, Field(ge=0, le=1)]], vector(("1", "1"), 2)] | None = None
    """Range of the variation of distances from the middle (0: no variation); null is [0, 1], or [0, 0] if convex."""
    num_vertices_range: Annotated[list[Annotated[Integer, Field(ge=3)]], vector(("1", "1"), 2)] = [4, 10]
    """Range of the number of vertices: the smallest number, and one more than the largest."""
    number: Annotated[Integer, Field(ge=1, le=1)] = 1
    """Number of outlines per object, which is always 1."""


def random_polygon(options: RandomOutline, convex: bool, closed: bool) -> core.RandomPolygon:
    """The core's random polygon for these parameters."""
    spikeyness = options.spikeyness_range
    return core.RandomPolygon(
        center_range=options.center_range,
        avg_radius_range=options.avg_radius_range,
        irregularity_range=options.irregularity_range,
        spikeyness_range=spikeyness if spikeyness is not None else [0.0, 0.0] if convex else [0.0, 1.0],
        num_vertices_range=options.num_vertices_range,
        closed=closed,
    )
