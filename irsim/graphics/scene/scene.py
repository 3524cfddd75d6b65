"""The scene: the content of a picture as plain data in world coordinates, independent of any drawing library.

:class:`irsim.objects.drawing.scene_builder.SceneBuilder` makes a :class:`Scene` from the state of one world. The
Matplotlib figure draws it, and a replay in a web page reads it as JSON (:meth:`Scene.as_dict`). Lengths are in metres,
angles in radians, and colours as the user wrote them; marks of a higher ``zorder`` cover lower ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.components.maps._site import HALF
from irsim.diagnostics.errors import ArgumentError
from irsim.graphics.scene.style import Color

__all__ = [
    "Beams",
    "Bounds",
    "Circle",
    "Dots",
    "Fog",
    "Geometry",
    "GridImage",
    "Group",
    "Label",
    "Line",
    "Look",
    "Mark",
    "Picture",
    "Region",
    "Scene",
    "Sector",
    "Segments",
    "Spots",
    "Stroke",
    "region_extent",
]


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
    """A filled area. ``rings``: (M, 2) rings; outlines run counter-clockwise, holes clockwise."""

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


@dataclass(slots=True, eq=False)
class Spots:
    """Discs of one radius around ``points`` (K, 2)."""

    points: Floats
    radius: float


@dataclass(slots=True, eq=False)
class Segments:
    """Straight lines, (K, 2, 2): start and end of each."""

    points: Floats


Geometry = Circle | Region | Line | Sector | Spots | Segments

_REGION_VALUES = 4
MAX_COORDINATE_M = 1e7
"""Largest absolute coordinate of a region [m]."""
MIN_REGION_SIDE_M = 1e-3
"""Smallest side of a region [m]."""
SOLID = ("-", "solid")
"""Styles of strokes without dashes."""


@dataclass(slots=True, eq=False)
class Stroke:
    """Outline of a mark.

    Attributes:
        color: Colour; None draws no outline.
        width: Line width in points, or in metres when ``metric``.
        metric: Whether ``width`` is in metres.
        style: ``-``, ``--``, ``-.``, ``:`` or their long names.
        round_caps: Whether open lines have round ends.
    """

    color: Color | None
    width: float = 1.0
    metric: bool = False
    style: Any = "-"
    round_caps: bool = False


@dataclass(slots=True, eq=False)
class Mark:
    """A shape that shows one part of an object.

    ``part`` says which: body, goal, arrow, view sector, trajectory, trail snapshot, … ``glow`` (x, y, reach) lets the
    fill fade with the distance from a point, up to a reach.
    """

    object: int
    part: str
    geometry: Geometry
    fill: Color | None
    stroke: Stroke
    alpha: float
    zorder: float
    glow: tuple[float, float, float] | None = None


Look = tuple[Color | None, Stroke, float]
"""Fill, outline and opacity of a mark."""
NO_CIRCLE = -1.0
"""Stands for the radius of a line or an area with corners."""


@dataclass(slots=True, eq=False)
class Group:
    """Marks of one part and layer whose shapes lie in common arrays; later ones cover earlier ones.

    Attributes:
        part, zorder: The part that they show, and their layer.
        closed: Whether shapes with corners are areas; else they are lines.
        objects: The object of each mark.
        points: (K, 2) points of all shapes; a circle has one, its centre.
        ranges: (N, 2) first and end of the points of each shape.
        radii: (N,) radii of circles; `NO_CIRCLE` for other shapes.
        looks: The look of each mark. If one has dashes, all have the same dashes and width.
    """

    part: str
    zorder: float
    closed: bool
    objects: Sequence[int]
    points: Floats
    ranges: NDArray[np.int64]
    radii: Floats
    looks: list[Look]

    def marks(self) -> list[Mark]:
        """The marks, one by one."""
        shapes = zip(self.objects, self.ranges.tolist(), self.radii.tolist(), self.looks, strict=True)
        return [
            Mark(number, self.part, self._shape(self.points[begin:end], radius), fill, stroke, alpha, self.zorder)
            for number, (begin, end), radius, (fill, stroke, alpha) in shapes
        ]

    def _shape(self, points: Floats, radius: float) -> Geometry:
        if radius >= 0.0:
            x, y = points[0].tolist()
            return Circle(x, y, radius)
        return Region([points]) if self.closed else Line(points)


@dataclass(slots=True, eq=False)
class Label:
    """A text. Its baseline starts at ``x, y``; ``anchor`` is the position of the thing that it names.

    ``halo`` is the colour and the width in points of an outline, with which it can be read on any ground.
    """

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
    bold: bool = False
    italic: bool = False
    halo: tuple[Color, float] | None = None


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

    ``highlights`` lists (beam, colour, alpha) of the beams that differ from the others. ``colors`` (B, 4) RGBA and
    ``widths`` (B,) in points are given if each beam has its own, and ``dots`` if hits are marked.
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
    """Fog over the unexplored area; ``explored`` (nx, ny) marks the cells of ``extent`` that are free of fog.

    ``soft`` is the width of its edge as a share of a cell, up to 1; 0 is a sharp edge.
    """

    explored: NDArray[np.bool_]
    extent: tuple[float, float, float, float]
    color: Color
    alpha: float
    zorder: float
    soft: float = 0.0


@dataclass(slots=True, eq=False)
class Picture:
    """An image in place of a body.

    ``box`` (x, y, length, width) is in the body frame, which ``pose`` places in the world. The colourful parts of the
    image are drawn in the hue ``tint``, unless that is None.
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
    """A map: ``levels`` (nx, ny) occupancy 0 to 100, i along +x, over ``extent`` (x from, x to, y from, y to).

    With a ``color``, occupied cells have it, ``unknown`` is the colour of cells that are neither free nor occupied, and
    free cells are transparent; else levels are shades of grey.
    """

    object: int
    levels: NDArray[np.uint8]
    extent: tuple[float, float, float, float]
    zorder: float
    color: Color | None = None
    unknown: Color | None = None


@dataclass(slots=True, eq=False)
class Scene:
    """One frame.

    Attributes:
        time: Simulated seconds.
        status: The environment's status word.
        extent: The world: x from, x to, y from, y to.
        center: Centre of the view; None shows the whole world.
        fog: The fog, or None in a world without fog.
        groups: More marks, above single ones of the same part and layer.
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
    groups: list[Group] = field(default_factory=list)

    def all_marks(self) -> list[Mark]:
        """All marks one by one, also out of groups."""
        return [*self.marks, *(mark for group in self.groups for mark in group.marks())]

    def look_at(self, extent: tuple[float, float, float, float]) -> None:
        """Show this part of the world instead: x from, x to, y from, y to."""
        self.extent, self.center = extent, None

    def of(self, object_id: int, part: str) -> Iterator[Mark]:
        """Iterate over the marks that show a part of one object."""
        return (mark for mark in self.all_marks() if mark.object == object_id and mark.part == part)

    def as_dict(self) -> dict[str, Any]:
        """Convert the scene to lists, dictionaries, numbers and strings; each geometry has a key ``kind``."""
        plain: dict[str, Any] = _plain(self)
        plain["marks"] += _plain([mark for group in self.groups for mark in group.marks()])
        del plain["groups"]
        return plain


class RegionError(ArgumentError):
    """The region is not a valid part of a world."""

    where = "region"


def region_extent(region: Sequence[float]) -> tuple[float, float, float, float]:
    """Convert a region from (x_min, y_min, x_max, y_max) to (x from, x to, y from, y to) [m].

    Raises:
        RegionError: The region is empty, too large, or does not have four numbers.
    """
    corners = [float(value) for value in region]
    if len(corners) == _REGION_VALUES and all(abs(value) <= MAX_COORDINATE_M for value in corners):
        x0, y0, x1, y1 = corners
        if x1 - x0 >= MIN_REGION_SIDE_M and y1 - y0 >= MIN_REGION_SIDE_M:
            return x0, x1, y0, y1
    given = ", ".join(f"{value:g}" for value in corners)
    limits = (
        f"x_max and y_max must exceed x_min and y_min by at least {MIN_REGION_SIDE_M:g} m, "
        f"and all must lie within {MAX_COORDINATE_M:g} m of 0"
    )
    raise RegionError(
        f"region {given} is not valid", f"give x_min, y_min, x_max, y_max in metres, in this order; {limits}"
    )


def _plain(value: Any) -> Any:
    if isinstance(value, GridImage):
        return _plain_grid(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if is_dataclass(value) and not isinstance(value, type):
        data = {entry.name: _plain(getattr(value, entry.name)) for entry in fields(value)}
        if isinstance(value, Geometry):
            data["kind"] = type(value).__name__.lower()
        return data
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def _plain_grid(grid: GridImage) -> dict[str, Any]:
    """Encode occupied cells as run lengths: row by row from the lowest, alternately free and occupied, free first."""
    full = (grid.levels.T > HALF).ravel()
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
