"""``polygon``: any simple outline, filled."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

import irsim._core as core
from irsim.components.options import RandomOutline, random_polygon
from irsim.options.registry import SHAPES
from irsim.options.units import Bool

SQUARE = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]


class Polygon(RandomOutline):
    """A filled outline of three or more corners, convex or not; without `vertices` a square of 2 m."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "polygon", "vertices": [[0, 0], [2, 0], [1, 1.5]]},
            {"name": "polygon", "random_shape": True, "is_convex": True, "avg_radius_range": [0.3, 0.8]},
        ]
    }

    name: Literal["polygon"] = "polygon"
    is_convex: Bool = False
    """With `random_shape`: put all vertices on a circle."""


@SHAPES.register(Polygon)
def parts(options: Polygon) -> list[core.Part]:
    """Geometry for the core, body frame."""
    if options.random_shape:
        return [random_polygon(options, options.is_convex, closed=True)]
    return [core.Polygon(vertices=options.vertices or SQUARE)]
