"""What a picture of the simulation contains, as plain data in world coordinates: no drawing library, JSON-able.

The class :class:`irsim.objects.drawing.scene_builder.SceneBuilder` makes a :class:`Scene` from the state of one world;
the Matplotlib figure draws it, and :meth:`Scene.as_dict` is what a replay in a web page reads. All lengths are in
metres, angles in radians, colours as the user wrote them; ``zorder`` is the layer: higher ones cover lower ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.diagnostics.errors import ArgumentError
from irsim.graphics.scene.palette import Color

__all__ = [
    "Beams",
    "Bounds",
    "Circle",
    "Dots",
    "Fog",
    "Geometry",
    "GridImage",
    "Label",
    "Line",
    "Mark",
    "Picture",
    "Region",
    "Scene",
    "Sector",
    "Stroke",
    "region_extent",
]

Floats = NDArray[np.float64]

Bounds = tuple[float, float, float, float]
"""Left, bottom, right, top."""


@dataclass(slots=True, eq=False)
class Circle:
    """A true circle."""

    x: float
    y: float
    radius: float


@dataclass(slots=True, eq=False)
class Region:
    """A filled area. ``rings``: (M, 2) outlines; the first of a part counter-clockwise, holes clockwise."""

    rings: list[Floats]


@dataclass(slots=True, eq=False)
class Line:
    """An open polyline. ``points``: (M, 2)."""

    points: Floats


@dataclass(slots=True, eq=False)
class Sector:
    """A slice of a disc from angle ``start`` to ``end`` (counter-clockwise)."""

    x: float
    y: float
    radius: float
    start: float
    end: float


Geometry = Circle | Region | Line | Sector

_OCCUPIED = 50
_CORNERS, _FARTHEST, _SMALLEST = 4, 1e7, 1e-3


@dataclass(slots=True, eq=False)
class Stroke:
    """Outline of a mark.

    Attributes:
        color: None draws no outline.
        width: In points, or in metres when ``metric``.
        style: ``-``, ``--``, ``-.``, ``:`` or their long names.
        round_caps: Ends of open lines.
    """

    color: Color | None
    width: float = 1.0
    metric: bool = False
    style: Any = "-"
    round_caps: bool = False


@dataclass(slots=True, eq=False)
class Mark:
    """Something with a shape: body, goal, arrow, view sector, trajectory or trail snapshot (``part``) of an object."""

    object: int
    part: str
    geometry: Geometry
    fill: Color | None
    stroke: Stroke
    alpha: float
    zorder: float


@dataclass(slots=True, eq=False)
class Label:
    """Text whose left end of the baseline is at ``x, y``; ``anchor`` is the position of what it names."""

    object: int
    part: str
    x: float
    y: float
    anchor: tuple[float, float]
    text: str
    color: Color
    size: float
    alpha: float
    zorder: float


@dataclass(slots=True, eq=False)
class Dots:
    """Round marks at ``points`` (K, 2), filled with ``colors`` (K, 4) RGBA; ``area`` in square points."""

    points: Floats
    colors: Floats
    area: float
    edge_color: Color
    edge_width: float
    zorder: float


@dataclass(slots=True, eq=False)
class Beams:
    """One scan: lines from ``origin`` to ``ends`` (B, 2).

    ``highlights`` are (beam, colour, alpha) of beams that differ from the rest. ``colors`` (B, 4) RGBA and ``widths``
    (B,) in points are there when each beam has its own, ``dots`` when hits are marked.
    """

    object: int
    sensor: int
    origin: tuple[float, float]
    ends: Floats
    color: Color
    alpha: float
    zorder: float
    highlights: list[tuple[int, Color, float]] = field(default_factory=list)
    colors: Floats | None = None
    widths: Floats | None = None
    dots: Dots | None = None


@dataclass(slots=True, eq=False)
class Fog:
    """What nobody has seen yet: ``explored`` (nx, ny) tells which cells over ``extent`` are clear."""

    explored: NDArray[np.bool_]
    extent: tuple[float, float, float, float]
    color: Color
    alpha: float
    zorder: float


@dataclass(slots=True, eq=False)
class Picture:
    """An image in place of a body: ``box`` (x, y, length, width) in the body frame, moved to the pose.

    What is colourful in it is drawn in the hue ``tint``, unless that is None.
    """

    object: int
    name: str
    box: tuple[float, float, float, float]
    pose: tuple[float, float, float]
    alpha: float
    zorder: float
    tint: Color | None = None


@dataclass(slots=True, eq=False)
class GridImage:
    """A map: ``levels`` (nx, ny) occupancy 0 to 100, i along +x, over ``extent`` (x from, x to, y from, y to)."""

    object: int
    levels: NDArray[np.uint8]
    extent: tuple[float, float, float, float]
    zorder: float


@dataclass(slots=True, eq=False)
class Scene:
    """One frame.

    Attributes:
        time: Simulated seconds.
        status: The environment's status word.
        extent: The world: x from, x to, y from, y to.
        center: Point the view is centred on; None shows the world.
        fog: None in a world without fog.
    """

    time: float
    status: str
    extent: tuple[float, float, float, float]
    center: tuple[float, float] | None
    marks: list[Mark]
    beams: list[Beams]
    labels: list[Label]
    pictures: list[Picture]
    fog: Fog | None = None
    grids: list[GridImage] = field(default_factory=list)

    def look_at(self, extent: tuple[float, float, float, float]) -> None:
        """Show this instead: x from, x to, y from, y to."""
        self.extent, self.center = extent, None

    def of(self, object_id: int, part: str) -> Iterator[Mark]:
        """The marks that show ``part`` of one object."""
        return (mark for mark in self.marks if mark.object == object_id and mark.part == part)

    def as_dict(self) -> dict[str, Any]:
        """The scene as lists, mappings, numbers and text; geometries carry their kind."""
        plain: dict[str, Any] = _plain(self)
        return plain


class RegionError(ArgumentError):
    """There is no such part of a world."""

    where = "region"


def region_extent(region: Sequence[float]) -> tuple[float, float, float, float]:
    """X from, x to, y from, y to of a part of a world given as x_min, y_min, x_max, y_max [m].

    Raises:
        RegionError: It is none.
    """
    corners = [float(value) for value in region]
    if len(corners) == _CORNERS and all(abs(value) <= _FARTHEST for value in corners):
        x0, y0, x1, y1 = corners
        if x1 - x0 >= _SMALLEST and y1 - y0 >= _SMALLEST:
            return x0, x1, y0, y1
    given = ", ".join(f"{value:g}" for value in corners)
    sizes = f"x_max and y_max at least {_SMALLEST:g} m beyond x_min and y_min, all within {_FARTHEST:g} m of 0"
    raise RegionError(
        f"there is no region {given}", f"give x_min, y_min, x_max, y_max in metres, in this order: {sizes}"
    )


def _plain(value: Any) -> Any:
    if isinstance(value, GridImage):
        return _plain_grid(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        data = {entry.name: _plain(getattr(value, entry.name)) for entry in fields(value)}
        if isinstance(value, Circle | Region | Line | Sector):
            data["kind"] = type(value).__name__.lower()
        return data
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def _plain_grid(grid: GridImage) -> dict[str, Any]:
    """Occupied cells as run lengths: row by row from the lowest, free and occupied in turn, free first."""
    full = (grid.levels.T > _OCCUPIED).ravel()
    ends = np.flatnonzero(np.diff(full.astype(np.int8), prepend=0))
    runs = np.diff(np.concatenate([[0], ends, [full.size]])).tolist()
    extent = [float(value) for value in grid.extent]
    return {
        "object": grid.object,
        "cells": list(grid.levels.shape),
        "extent": extent,
        "zorder": grid.zorder,
        "runs": runs,
    }
