"""Dashed lines and outlines, which are painted if they have few dashes."""

from __future__ import annotations

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.scene import Line, Mark, Region, Stroke

__all__ = ["outline", "pattern_of"]

MAX_DASHES = 2000
"""A line with more dashes is left to Matplotlib, which cuts it to the view first."""


def pattern_of(stroke: Stroke, points: Floats, points_per_metre: float, lines: int = 1) -> list[float] | None:
    """Lengths of dashes and gaps [pt] of lines that are painted; None if they have too many, or a named style.

    Args:
        stroke: The stroke of the lines, which is not solid.
        points: Their points (K, 2) [m].
        points_per_metre: Scale of the view.
        lines: Number of lines.
    """
    if not isinstance(stroke.style, tuple) or stroke.metric or not stroke.width > 0:
        return None
    offset, pattern = stroke.style
    if len(points) < 2 or offset or len(pattern) % 2 or not min(pattern, default=0) > 0:
        return None
    steps = points[1:] - points[:-1]
    length = float(np.hypot(steps[:, 0], steps[:, 1]).sum()) * points_per_metre
    if not length <= MAX_DASHES * lines * sum(pattern) * stroke.width:
        return None
    return [part * stroke.width for part in pattern]


def outline(mark: Mark) -> Floats | None:
    """The points of a line, or of the closed outline of a region without holes; None for other shapes."""
    shape = mark.geometry
    if isinstance(shape, Line):
        return shape.points
    if isinstance(shape, Region) and len(shape.rings) == 1:
        return np.concatenate([shape.rings[0], shape.rings[0][:1]])
    return None
