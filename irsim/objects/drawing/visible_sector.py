"""The part of a field of view that an object sees, which ends at the bodies in it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.outline import Cells, outline
from irsim.graphics.scene.scene import Region

if TYPE_CHECKING:
    from irsim.graphics.scene.bodies import Pose
    from irsim.objects.view import ObjectView

__all__ = ["visible_sector"]

_RAY_ANGLE = math.radians(0.5)
"""Angle between two rays [rad]."""


def visible_sector(view: ObjectView, angle: float, radius: float, pose: Pose) -> Region:
    """Return what an object sees of a sector: up to the nearest object that is not `unobstructed`, in each direction.

    Args:
        view: The object.
        angle: Full opening angle [rad].
        radius: Range [m].
        pose: Where it is.
    """
    import shapely

    simulation, (x, y, heading) = view._simulation, pose
    angle = min(angle, 2 * math.pi)
    bearings = np.linspace(-angle / 2, angle / 2, 1 + math.ceil(angle / _RAY_ANGLE)) + heading
    directions = np.stack([np.cos(bearings), np.sin(bearings)], axis=1)
    reach = np.full(len(bearings), radius)
    rays: Floats = np.stack([np.broadcast_to([x, y], directions.shape), directions * radius + [x, y]], axis=1)
    lines, origin = shapely.linestrings(rays), shapely.Point(x, y)
    for other in simulation.views(view.world):
        if other.id == view.id or other.unobstructed or simulation.appeared[other.row] < 0:
            continue
        parts = outline(simulation.state, other.row, world_frame=True)
        for cells in (part for part in parts.parts if isinstance(part, Cells)):
            reach = np.minimum(reach, [cells.grid.cast([x, y], one, radius) for one in directions.tolist()])
        if any(isinstance(part, Cells) for part in parts.parts):
            continue
        body = parts.shapely()
        if shapely.distance(origin, body) < radius:
            met = shapely.distance(origin, shapely.intersection(lines, body))
            reach = np.fmin(reach, met)
    rim = np.array([x, y]) + directions * reach[:, None]
    return Region([rim if angle >= 2 * math.pi else np.concatenate([[[x, y]], rim])])
