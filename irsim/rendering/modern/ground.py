"""The layers below bodies: cells of maps with their contour, fog with its lines, zones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.components.maps._site import HALF
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import (
    Bounds,
    Circle,
    Fog,
    Geometry,
    GridImage,
    Label,
    Line,
    Mark,
    Region,
    Segments,
    Stroke,
)
from irsim.graphics.scene.theme import Theme, seen
from irsim.graphics.scene.zones import draw_zones
from irsim.rendering.modern.frame import FRAME, label, stroke
from irsim.rendering.modern.layout import Layout

if TYPE_CHECKING:
    from irsim.scenario.model.zones import Zone

__all__ = ["contour_marks", "fog_marks", "is_seen", "shown_fog", "shown_grid", "zone_parts"]

_ZONE_Z, _MAP_Z, FOG_Z, HIDING_Z, _NAME_Z = 0.5, 1.0, 1.15, 1.55, 7.0
_CONTOUR = 1.2
MAX_CONTOUR = 20_000
"""Number of pieces of a contour above which it is left out: cells are then smaller than the line."""
_FOG_ALPHA = 0.92
_FOG_EDGE = 2 / 6
"""Width of the edge of fog, as a share of a cell."""
_HATCH_STEP, _HATCH, _HATCH_ALPHA = 9.0, 0.9, 0.22
_SAMPLES_PER_CELL = 2
MIN_SEEN_SHARE = 0.25
"""A body is shown in full where this share of its outline has been seen."""
_ZONE_ALPHA, _ZONE_EDGE_ALPHA = 0.09, 0.8
_ZONE_EDGE, _ZONE_LINE = 1.2, 2.2
_DASHES = (0, (4, 3))


def shown_grid(grid: GridImage, theme: Theme) -> GridImage:
    """A map in the colours of a theme."""
    return replace(grid, color=theme.rock, unknown=theme.still, zorder=_MAP_Z)


def contour_marks(grid: GridImage, theme: Theme) -> list[Mark]:
    """The edges of the occupied cells of a map."""
    full = np.pad(np.asarray(grid.levels) > HALF, 1)
    x0, x1, y0, y1 = grid.extent
    dx, dy = (x1 - x0) / grid.levels.shape[0], (y1 - y0) / grid.levels.shape[1]
    upright = _runs(full[1:, 1:-1] != full[:-1, 1:-1])  # edges between columns, by column
    level = _runs((full[1:-1, 1:] != full[1:-1, :-1]).T)
    lines = [((c, a), (c, b)) for c, a, b in upright] + [((a, c), (b, c)) for c, a, b in level]
    if not 0 < len(lines) <= MAX_CONTOUR:
        return []
    places = Segments(np.array(lines) * (dx, dy) + (x0, y0))
    return [Mark(grid.object, "contour", places, None, stroke(theme.still_edge, _CONTOUR), 1.0, _MAP_Z + 0.05)]


def _runs(edges: NDArray[np.bool_]) -> list[tuple[int, int, int]]:
    """Row, start and end of the runs in the rows of an array."""
    steps = np.diff(np.pad(edges, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(steps == 1)
    _, ends = np.nonzero(steps == -1)
    return list(zip(rows.tolist(), starts.tolist(), ends.tolist(), strict=True))


def shown_fog(fog: Fog, theme: Theme, *, hides: bool = False) -> Fog:
    """Fog in the colours of a theme, below static bodies.

    Args:
        fog: The fog.
        theme: The theme.
        hides: Whether nothing shines through it: it lies above static bodies, and leaves the cells beside free ones,
            where the seen sides of bodies are, free as well.
    """
    if hides:
        free = np.pad(np.asarray(fog.explored, dtype=bool), 1)
        beside = [np.roll(free, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        grown = np.logical_or.reduce(beside)[1:-1, 1:-1]
        return replace(fog, explored=grown, color=theme.fog, alpha=1.0, zorder=HIDING_Z, soft=_FOG_EDGE)
    return replace(fog, color=theme.fog, alpha=_FOG_ALPHA, zorder=FOG_Z, soft=_FOG_EDGE)


def fog_marks(fog: Fog, layout: Layout, theme: Theme) -> list[Mark]:
    """Lines over fog as it is shown, which tell it from a body."""
    x0, x1, y0, y1 = fog.extent
    columns, rows = fog.explored.shape
    step = layout.metres(_HATCH_STEP) * np.sqrt(2)
    sample = min((x1 - x0) / columns, (y1 - y0) / rows) / _SAMPLES_PER_CELL
    along = np.arange(0.0, y1 - y0, sample)
    x, y = np.arange(x0 - (y1 - y0), x1, step)[:, None] + along, y0 + along
    inside = (x >= x0) & (x < x1)
    i = np.clip(((x - x0) / (x1 - x0) * columns).astype(int), 0, columns - 1)
    j = np.clip(((y - y0) / (y1 - y0) * rows).astype(int), 0, rows - 1)
    runs = np.array(_runs(inside & ~np.asarray(fog.explored, dtype=bool)[i, j]), dtype=int).reshape(-1, 3)
    if not len(runs):
        return []
    line, first, last = runs[:, 0], runs[:, 1], runs[:, 2] - 1
    ends = np.stack([x[line, first], y[first], x[line, last], y[last]], axis=1).reshape(-1, 2, 2)
    edge = stroke(theme.still_edge, _HATCH)
    return [Mark(FRAME, "hatch", Segments(ends), None, edge, _HATCH_ALPHA, fog.zorder + 0.01)]


def is_seen(fog: Fog, geometry: Geometry) -> bool:
    """Whether enough of the outline of a body lies in or beside cells that are free of fog."""
    points = _outline(geometry)
    x0, x1, y0, y1 = fog.extent
    columns, rows = fog.explored.shape
    free = np.pad(np.asarray(fog.explored, dtype=bool), 1)
    i = ((points[:, 0] - x0) / (x1 - x0) * columns).astype(int)
    j = ((points[:, 1] - y0) / (y1 - y0) * rows).astype(int)
    inside = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    if not inside.any():
        return True
    i, j = i[inside] + 1, j[inside] + 1
    near = free[i, j] | free[i - 1, j] | free[i + 1, j] | free[i, j - 1] | free[i, j + 1]
    return bool(near.mean() >= MIN_SEEN_SHARE)


def _outline(geometry: Geometry) -> Floats:
    """Points along the outline of a body."""
    if isinstance(geometry, Region | Line):
        ring = geometry.rings[0] if isinstance(geometry, Region) else geometry.points
        closed = np.concatenate([ring, ring[:1]]) if isinstance(geometry, Region) else ring
        shares = np.linspace(0, 1, 12, endpoint=False)[:, None, None]
        points: Floats = (closed[:-1] + shares * np.diff(closed, axis=0)).reshape(-1, 2)
        return points
    left, bottom, right, top = bounds(geometry)
    angles = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    middle, half = ((left + right) / 2, (bottom + top) / 2), ((right - left) / 2, (top - bottom) / 2)
    return np.stack([middle[0] + half[0] * np.cos(angles), middle[1] + half[1] * np.sin(angles)], axis=1)


def zone_parts(zones: Sequence[Zone], layout: Layout, theme: Theme) -> tuple[list[Mark], list[Label]]:
    """Zones: areas pale with a dashed edge and their name in the upper left corner, lines dashed."""
    x0, x1, y0, y1 = world = layout.world
    drawn = draw_zones(zones, theme.zone, world)
    marks, labels = list[Mark](), list[Label]()
    lines = {mark.object for mark in drawn.marks if isinstance(mark.geometry, Line)}
    for mark in drawn.marks:
        color = seen(mark.fill if mark.fill is not None else mark.stroke.color, theme.paper, theme.least_edge)
        if mark.object in lines:
            line = isinstance(mark.geometry, Line)
            dashed = stroke(color, _ZONE_LINE, _DASHES) if line else Stroke(None)
            marks.append(replace(mark, fill=None if line else color, stroke=dashed, alpha=1.0, zorder=_ZONE_Z))
        elif mark.fill is not None:
            marks.append(replace(mark, fill=color, alpha=_ZONE_ALPHA, zorder=_ZONE_Z))
        else:
            dashed = stroke(color, _ZONE_EDGE, _DASHES)
            marks.append(replace(mark, stroke=dashed, alpha=_ZONE_EDGE_ALPHA, zorder=_ZONE_Z + 0.01))
    shapes = {mark.object: mark.geometry for mark in drawn.marks}
    size = layout.sizes.name
    for one in drawn.labels:
        left, bottom, right, top = _within(bounds(shapes[one.object]), (x0, y0, x1, y1))
        if left > right or bottom > top:
            continue
        color = seen(one.color, theme.paper, theme.least_name)
        inside = one.object not in lines and not isinstance(shapes[one.object], Circle)
        x = left + layout.metres(4)
        y = top - layout.metres(size + 2) if inside else top + layout.metres(4)
        if y + layout.metres(size) > y1:
            y = top - layout.metres(size + 4)
        text = label(one.object, "zone", (x, y), one.text, color, size, zorder=_NAME_Z, italic=True)
        labels.append(replace(text, halo=(theme.paper, 2.0)))
    return marks, labels


def _within(box: Bounds, view: Bounds) -> Bounds:
    return max(box[0], view[0]), max(box[1], view[1]), min(box[2], view[2]), min(box[3], view[3])
