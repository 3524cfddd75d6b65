"""Parts of a run as the replay page reads them: shapes, colours, sensors, map cells, and series of numbers."""

from __future__ import annotations

import json
import math
import zlib
from collections.abc import Sequence
from dataclasses import astuple
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean
from irsim.graphics.scene.bodies import geometry_of
from irsim.graphics.scene.scene import Circle, Geometry, Line, Region
from irsim.graphics.scene.theme import THEMES, Theme, seen
from irsim.simulation.scene import Lidar, Look, SceneDescription

if TYPE_CHECKING:
    from irsim.scenario.model.zones import Zone

__all__ = ["Columns", "Integers", "changes", "page_grid", "page_objects", "page_zones", "quantised"]

_DECIMALS = 4
"""Decimals of coordinates."""


def page_objects(scene: SceneDescription) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[dict[str, Any]]]:
    """Shapes, objects and lidars of a scene.

    Returns:
        The distinct shapes, each in its own frame; the objects in the order of the trace, with the index of their
        ``shape``; the lidars, with the index of their ``object``, their ``pose`` in the frame of the object, and the
        ``key`` of their ranges in the trace, and their ``timing``: rate and latency.
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
                "arrival": one.threshold,
                "shape": shapes.setdefault(text, len(shapes)) if text else -1,
                "kind": one.look.kind,
                "shades": {theme.name: _shades(theme, one.look) for theme in THEMES.values()},
                "alpha": round(one.look.alpha, 3),
                "goal": one.look.goal,
                "arrow": one.look.arrow,
                "motion": one.look.motion,
            }
        )
        lidars += [_lidar(lidar, one.row) for lidar in one.lidars]
    return [json.loads(text) for text in shapes], objects, lidars


def page_grid(scene: SceneDescription) -> dict[str, Any] | None:
    """Cells of the map, None without a map.

    Returns:
        Number of cells along x and y, ``extent`` [m], and ``runs``: lengths of alternating runs of free and occupied
        cells. ``unknown`` has such runs of known and unknown cells if any are unknown.
    """
    if scene.grid is None:
        return None
    made = {
        "cells": list(scene.grid.occupied.shape),
        "extent": [float(v) for v in scene.grid.extent],
        "runs": _runs(scene.grid.occupied),
    }
    unknown = scene.grid.unknown
    return {**made, "unknown": _runs(unknown)} if unknown.any() else made


def _runs(cells: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Lengths of alternating runs of cells that are not set and that are, row by row from the lowest."""
    full = cells.T.ravel()
    ends = np.flatnonzero(np.diff(full.astype(np.int8), prepend=0))
    return np.diff(np.concatenate([[0], ends, [full.size]]))


def page_zones(zones: Sequence[Zone]) -> list[dict[str, Any]]:
    """Zones with their ``name``, ``colors`` by theme, outline, and the place ``at`` of their name."""
    drawn = list[dict[str, Any]]()
    for zone in zones:
        left, _, _, top = zone.bounds
        colors = {
            theme.name: seen(theme.zone if zone.color is None else zone.color, theme.paper, theme.least_edge)
            for theme in THEMES.values()
        }
        shape = {"line" if zone.is_line else "rings": _flat(zone.points) if zone.is_line else [_flat(zone.points)]}
        if zone.circle is not None:
            shape = {"circle": [_rounded(value) for value in (*zone.circle.center, zone.circle.radius)]}
        drawn.append({"name": clean(zone.title), "colors": colors, "at": [_rounded(left), _rounded(top)], **shape})
    return drawn


def _shades(theme: Theme, look: Look) -> list[str]:
    """Fill, edge, name and dart of an object in one theme."""
    return list(astuple(theme.shades(look.kind, look.color)))


def _lidar(lidar: Lidar, row: int) -> dict[str, Any]:
    return {
        "object": row,
        "key": lidar.key,
        "timing": (lidar.rate, lidar.latency),
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


Integers = NDArray[np.int32]
_MAX_INTEGER = 2**31 - 1
_SMALLEST = 9
"""Level of compression of a page, which is written once and kept."""


class Columns:
    """Named arrays of 32-bit integers and one head of plain data, as one block of bytes.

    Decompressed (zlib), a block is: length of the head (4 bytes, little endian); the head as JSON, whose ``columns``
    lists name, shape and order of each array; the arrays. An array is differenced ``order`` times along its last
    axis (in wrapping arithmetic, with zeros before the first value), its numbers are zigzag-encoded so that small ones
    of either sign have few bits, and first all lowest bytes are written, then all second bytes, and so on.
    """

    def __init__(self) -> None:
        self._list: list[dict[str, Any]] = []
        self._bytes: list[bytes] = []

    def add(self, name: str, values: Any, order: int = 0) -> None:
        """Add an array.

        Args:
            name: Name of the array in the page.
            values: Integers that fit into 32 bits, of any shape.
            order: Number of times that neighbours along the last axis are subtracted.

        Raises:
            OverflowError: A number does not fit.
        """
        wide = np.asarray(values, dtype=np.int64)
        if wide.size and not -(2**31) <= wide.min() <= wide.max() < 2**31:
            raise OverflowError(f"{name} does not fit into 32 bits")
        array = wide.astype(np.int32)
        self._list.append({"name": name, "shape": list(array.shape), "order": order})
        self._bytes.append(folded(array, order))

    def block(self, head: dict[str, Any], level: int = _SMALLEST) -> bytes:
        """The block, compressed with this level."""
        text = json.dumps({**head, "columns": self._list}, separators=(",", ":"), allow_nan=False).encode()
        return zlib.compress(len(text).to_bytes(4, "little") + text + b"".join(self._bytes), level)


def folded(array: Integers, order: int) -> bytes:
    """Bytes of one array, differenced ``order`` times and zigzag-encoded."""
    values = array.astype(np.int32)
    for _ in range(order):
        before = np.zeros((*values.shape[:-1], 1), dtype=np.int32)
        values = np.diff(values, axis=-1, prepend=before)
    numbers = ((values << 1) ^ (values >> 31)).astype("<i4")
    return numbers.reshape(-1, 1).view(np.uint8).T.tobytes()


def quantised(values: Any, quantum: float) -> Integers:
    """Values as whole multiples of ``quantum``; NaN becomes 0, and values beyond 32 bits the largest that fit."""
    quanta = np.asarray(values, dtype=np.float64) / quantum
    scaled = np.nan_to_num(quanta, nan=0.0, posinf=_MAX_INTEGER, neginf=-_MAX_INTEGER)
    return np.clip(np.rint(scaled), -_MAX_INTEGER, _MAX_INTEGER).astype(np.int32)


def changes(series: Sequence[NDArray[Any]]) -> tuple[Integers, Integers]:
    """Find the rows in which the values of each object change; the first row counts as a change.

    Args:
        series: Arrays (T, N); NaN equals NaN.

    Returns:
        Rows and objects of the changes, sorted by object, then by row.
    """
    changed = np.zeros(series[0].shape, dtype=bool)
    changed[0] = True
    for values in series:
        now, before = values[1:], values[:-1]
        same = now == before
        if values.dtype.kind == "f":
            same |= np.isnan(now) & np.isnan(before)
        changed[1:] |= ~same
    objects, rows = np.nonzero(changed.T)
    return rows.astype(np.int32), objects.astype(np.int32)
