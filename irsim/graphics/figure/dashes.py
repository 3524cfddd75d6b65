"""Dashed lines and outlines, which are painted if they have few dashes."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.scene import Line, Mark, Region

__all__ = ["SOLID", "is_paintable", "outline"]

SOLID = ("-", "solid")
MAX_DASHES = 2000
"""A line with more dashes is left to Matplotlib, which cuts it to the view first."""


def is_paintable(mark: Mark, points_per_metre: float) -> bool:
    """Whether a mark is solid, or has few dashes whose lengths its style gives."""
    stroke = mark.stroke
    if stroke.style in SOLID:
        return True
    if not isinstance(stroke.style, tuple) or stroke.metric or not stroke.width > 0:
        return False
    points, (offset, pattern) = outline(mark), stroke.style
    if points is None or len(points) < 2 or offset or len(pattern) % 2 or not min(pattern, default=0) > 0:
        return False
    steps = np.diff(points, axis=0)
    length = float(np.hypot(steps[:, 0], steps[:, 1]).sum()) * points_per_metre
    return length <= MAX_DASHES * sum(pattern) * stroke.width


def outline(mark: Mark) -> Floats | None:
    """The points of a line, or of the closed outline of a region without holes; None for other shapes."""
    shape = mark.geometry
    if isinstance(shape, Line):
        return shape.points
    if isinstance(shape, Region) and len(shape.rings) == 1:
        return np.concatenate([shape.rings[0], shape.rings[0][:1]])
    return None
