"""Draws the contacts of an object: a dot at each contact point, and a line whose length shows the force."""

from __future__ import annotations

from typing import Any

import numpy as np

from irsim.graphics.scene.scene import Beams, Dots, Line, Mark, Stroke

__all__ = ["draw_forces"]

_ZORDER = 5


def draw_forces(contact: Any, sensor: int = 0) -> tuple[list[Mark], list[Beams]]:
    """Return the lines of the contact forces on an object, and the dots at which they start.

    Args:
        contact: The :class:`irsim.objects.sensors.contact.Contact2D` of the object.
        sensor: Index among the sensors of the object.
    """
    reports = contact.reports
    if not reports:
        return [], []
    points = np.array([report.point for report in reports])
    forces = np.array([report.normal * report.force for report in reports])
    number, alpha = contact.obj_id, contact.alpha
    stroke = Stroke(contact.color, contact.linewidth)
    marks = [
        Mark(number, "contact", Line(np.array([p, p + f * contact.force_scale])), None, stroke, alpha, _ZORDER)
        for p, f in zip(points, forces, strict=True)
    ]
    from matplotlib.colors import to_rgba

    dots = Dots(
        points=points,
        colors=np.tile(to_rgba(contact.color, alpha), (len(points), 1)),
        area=contact.marker_size**2,
        edge_color=contact.color,
        edge_width=0.0,
        zorder=_ZORDER,
    )
    nothing = np.zeros((0, 2))
    beams = Beams(number, sensor, (0.0, 0.0), nothing, contact.color, alpha, _ZORDER)
    beams.dots = dots
    return marks, [beams]
