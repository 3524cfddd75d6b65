"""Shapes, colours, sensors and map cells of a run as plain data, as the replay page draws them."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.text import clean
from irsim.graphics.scene.bodies import geometry_of
from irsim.graphics.scene.scene import Circle, Geometry, Line, Region
from irsim.graphics.scene.style import Palette
from irsim.simulation.scene import Lidar, SceneDescription

if TYPE_CHECKING:
    from irsim.scenario.model.zones import Zone

__all__ = ["page_grid", "page_objects", "page_zones"]

_DECIMALS = 4
"""Decimals of coordinates."""


def page_objects(scene: SceneDescription) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[dict[str, Any]]]:
    """Shapes, objects and lidars of a scene.

    Returns:
        The distinct shapes, each in its own frame; the objects in the order of the trace, with the index of their
        ``shape``; the lidars, with the index of their ``object``, their ``pose`` in the frame of the object, and the
        ``key`` of their ranges in the trace.
    """
    shapes: dict[str, int] = {}
    objects, lidars = list[dict[str, Any]](), list[dict[str, Any]]()
    for one in scene.objects:
        assert one.look is not None
        text = json.dumps(_plain(geometry_of(one.parts))) if one.parts else ""
        objects.append(
            {
                "name": clean(one.name),
                "role": one.role,
                "pose": [_rounded(value) for value in one.pose],
                "radius": _rounded(one.radius),
                "seen": one.solid,
                "drive": one.drive,
                "arrival": one.threshold,
                "shape": shapes.setdefault(text, len(shapes)) if text else -1,
                "color": _hex(one.look.color),
                "alpha": round(one.look.alpha, 3),
                "goal": one.look.goal,
                "arrow": one.look.arrow,
            }
        )
        lidars += [_lidar(lidar, one.row) for lidar in one.lidars]
    return [json.loads(text) for text in shapes], objects, lidars


def page_grid(scene: SceneDescription) -> dict[str, Any] | None:
    """Cells of the map, None without a map.

    Returns:
        Number of cells along x and y, ``extent`` [m], and ``runs``: lengths of alternating runs of free and occupied
        cells.
    """
    if scene.grid is None:
        return None
    full = scene.grid.occupied.T.ravel()
    ends = np.flatnonzero(np.diff(full.astype(np.int8), prepend=0))
    runs = np.diff(np.concatenate([[0], ends, [full.size]]))
    return {"cells": list(scene.grid.occupied.shape), "extent": [float(v) for v in scene.grid.extent], "runs": runs}


def page_zones(zones: Sequence[Zone]) -> list[dict[str, Any]]:
    """Zones with their ``name``, ``color``, outline, and the place ``at`` of their name."""
    drawn = list[dict[str, Any]]()
    for zone in zones:
        left, _, _, top = zone.bounds
        color = _hex(Palette().zone if zone.color is None else zone.color)
        shape = {"line" if zone.is_line else "rings": _flat(zone.points) if zone.is_line else [_flat(zone.points)]}
        if zone.circle is not None:
            shape = {"circle": [_rounded(value) for value in (*zone.circle.center, zone.circle.radius)]}
        drawn.append({"name": clean(zone.name), "color": color, "at": [_rounded(left), _rounded(top)], **shape})
    return drawn


def _lidar(lidar: Lidar, row: int) -> dict[str, Any]:
    return {
        "object": row,
        "key": lidar.key,
        "pose": [_rounded(value) for value in lidar.mount],
        "beams": lidar.beams,
        "first": lidar.angle_min,
        "between": lidar.between,
        "range_min": lidar.range_min,
        "range_max": lidar.range_max,
    }


def _plain(geometry: Geometry) -> dict[str, Any]:
    """A geometry as plain data, with coordinates as flat lists of alternating x and y."""
    if isinstance(geometry, Circle):
        return {"circle": [_rounded(value) for value in (geometry.x, geometry.y, geometry.radius)]}
    if isinstance(geometry, Region):
        return {"rings": [_flat(ring) for ring in geometry.rings]}
    assert isinstance(geometry, Line)
    return {"line": _flat(geometry.points)}


def _flat(points: Any) -> list[float]:
    return [_rounded(value) for value in np.asarray(points, dtype=np.float64).ravel().tolist()]


def _rounded(value: float) -> float:
    return round(value, _DECIMALS) if math.isfinite(value) else 0.0


def _hex(color: Any) -> str:
    """A colour of a scenario as ``#rrggbb``."""
    from matplotlib.colors import to_hex

    return str(to_hex("black" if color is None or color == "none" else color))
