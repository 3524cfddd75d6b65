"""``linestring``: an open polyline, such as a wall."""

from __future__ import annotations

from typing import Literal

from irsim import _core as core
from irsim.registry import SHAPES
from irsim.shapes._options import RandomOutline, random_polygon
from irsim.units import Bool


class Linestring(RandomOutline):
    """Line segments from vertex to vertex, without thickness, not closed."""

    name: Literal["linestring"] = "linestring"
    is_convex: Bool = True
    """With `random_shape`: all vertices on a circle."""


@SHAPES.register(Linestring)
def parts(options: Linestring) -> list[core.Part]:
    """Geometry for the core, body frame."""
    if options.random_shape:
        return [random_polygon(options, options.is_convex, closed=False)]
    return [core.Linestring(vertices=options.vertices or [])]
