"""Shapes, colours, sensors and map cells of a run as plain data, as the replay page draws them."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.text import clean
from irsim.components.maps._site import OCCUPIED
from irsim.graphics.scene.palette import Palette
from irsim.graphics.scene.scene import Circle, Geometry, Line, Region
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.sensors.lidar import FMCWLidar2D, Lidar2D
from irsim.objects.views import views

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["page_grid", "page_objects", "page_zones"]

_DECIMALS = 4
"""Decimals of coordinates."""


def page_objects(env: Env) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[dict[str, Any]]]:
    """Shapes, objects and lidars of an environment at its start.

    Returns:
        The distinct shapes, each in its own frame; the objects in the order of the trace, with the index of their
        ``shape``; the lidars, with the index of their ``object``, their ``pose`` in the frame of the object, and the
        ``key`` of their ranges in the trace.
    """
    builder = SceneBuilder(env.simulation)
    shapes: dict[str, int] = {}
    objects, lidars = list[dict[str, Any]](), list[dict[str, Any]]()
    for row, view in enumerate(views(env.simulation)):
        record = view.record
        drawn: dict[str, Any] = {
            "name": clean(view.name),
            "role": record.role,
            "pose": [_rounded(value) for value in env.simulation.pose[row].tolist()],
            "radius": _rounded(float(env.simulation.radius[row])),
            "seen": not record.unobstructed,
            "drive": getattr(record.kinematics, "name", None),
            "arrival": record.goal_threshold,
        }
        if view.record.is_map:
            drawn.update(shape=-1, color="#000000", alpha=1.0, goal=False, arrow=False)
        else:
            style = builder.style(view, {})
            text = json.dumps(_plain(builder.body(view).geometry))
            drawn.update(
                shape=shapes.setdefault(text, len(shapes)),
                color=_hex(style.obj_color),
                alpha=round(float(style.obj_alpha), 3),
                goal=record.role == "robot" or bool(style.show_goal),
                arrow=bool(style.show_arrow),
            )
        objects.append(drawn)
        native = [sensor for sensor in view.sensors if isinstance(sensor, Lidar2D | FMCWLidar2D)]
        lidars += [_lidar(sensor, row, f"{view.name}/{number}") for number, sensor in enumerate(native)]
    return [json.loads(text) for text in shapes], objects, lidars


def page_grid(env: Env) -> dict[str, Any] | None:
    """Cells of the map, None without a map.

    Returns:
        Number of cells along x and y, ``extent`` [m], and ``runs``: lengths of alternating runs of free and occupied
        cells.
    """
    builder = SceneBuilder(env.simulation)
    for view in views(env.simulation):
        if view.record.is_map:
            grid = builder.grid(view)
            full = (grid.levels.T > OCCUPIED).ravel()
            ends = np.flatnonzero(np.diff(full.astype(np.int8), prepend=0))
            runs = np.diff(np.concatenate([[0], ends, [full.size]]))
            return {"cells": list(grid.levels.shape), "extent": [float(v) for v in grid.extent], "runs": runs}
    return None


def page_zones(env: Env) -> list[dict[str, Any]]:
    """Zones with their ``name``, ``color``, outline, and the place ``at`` of their name."""
    zones = list[dict[str, Any]]()
    for zone in env.scenario.world.zones:
        left, _, _, top = zone.bounds
        color = _hex(Palette().zone if zone.color is None else zone.color)
        shape = {"line" if zone.is_line else "rings": _flat(zone.points) if zone.is_line else [_flat(zone.points)]}
        if zone.circle is not None:
            shape = {"circle": [_rounded(value) for value in (*zone.circle.center, zone.circle.radius)]}
        zones.append({"name": clean(zone.name), "color": color, "at": [_rounded(left), _rounded(top)], **shape})
    return zones


def _lidar(sensor: Lidar2D, row: int, key: str) -> dict[str, Any]:
    return {
        "object": row,
        "key": key,
        "pose": [_rounded(float(value)) for value in sensor.offset[:, 0]],
        "beams": sensor.number,
        "first": sensor.angle_min,
        "between": sensor.angle_inc,
        "range_min": sensor.range_min,
        "range_max": sensor.range_max,
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
