"""Shapes, colours, sensors and cells as the page draws them, as plain data."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.text import clean
from irsim.graphics.scene.scene import Circle, Geometry, Line, Region
from irsim.objects.drawing.scene_builder import SceneBuilder
from irsim.objects.sensors.lidar import FMCWLidar2D, Lidar2D
from irsim.objects.views import views

if TYPE_CHECKING:
    from irsim.env import Env

__all__ = ["drawn_grid", "drawn_objects"]

_DECIMALS = 4
_OCCUPIED = 50


def drawn_objects(env: Env) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[dict[str, Any]]]:
    """Shapes, objects and lidars of an environment at its start.

    Returns:
        Shapes in their own frame, each once; objects in the order of the trace, ``shape`` is a place among the
        shapes; lidars, ``object`` is a place among the objects, ``pose`` is in the frame of the object, and ``key``
        names its ranges in the trace.
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
        if view.shape == "map":
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


def drawn_grid(env: Env) -> dict[str, Any] | None:
    """Cells of the map: how many along x and y, where, and ``runs``: how many are free and occupied in turn."""
    builder = SceneBuilder(env.simulation)
    for view in views(env.simulation):
        if view.shape == "map":
            grid = builder.grid(view)
            full = (grid.levels.T > _OCCUPIED).ravel()
            ends = np.flatnonzero(np.diff(full.astype(np.int8), prepend=0))
            runs = np.diff(np.concatenate([[0], ends, [full.size]]))
            return {"cells": list(grid.levels.shape), "extent": [float(v) for v in grid.extent], "runs": runs}
    return None


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
    """A geometry with its coordinates as flat lists: x, y, x, y and so on."""
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
    """``#rrggbb`` of any colour a scenario may name."""
    from matplotlib.colors import to_hex

    return str(to_hex("black" if color is None or color == "none" else color))
