"""``linestring``: an open polyline, such as a wall."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.components.options import RandomOutline, random_polygon
from irsim.options.registry import SHAPES
from irsim.options.units import Bool


class Linestring(RandomOutline):
    """Line segments from vertex to vertex, without thickness, not closed."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "linestring", "vertices": [[0, 0], [3, 0], [3, 3]]}],
        "if": {"not": {"required": ["random_shape"], "properties": {"random_shape": {"const": True}}}},
        "then": {"required": ["vertices"], "properties": {"vertices": {"type": "array"}}},
    }

    name: Literal["linestring"] = "linestring"
    is_convex: Bool = True
    """With `random_shape`: put all vertices on a circle."""


@SHAPES.register(Linestring)
def parts(options: Linestring) -> list[core.Part]:
    """Geometry for the core, body frame."""
    if options.random_shape:
        return [random_polygon(options, options.is_convex, closed=False)]
    return [core.Linestring(vertices=options.vertices or [])]
