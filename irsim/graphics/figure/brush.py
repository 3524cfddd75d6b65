"""The brush: paints marks straight into the pixels of a canvas, as Agg draws them, many with one call."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.graphics.figure.canvas import Canvas, geometry_path, rgba
from irsim.graphics.figure.dashes import outline, pattern_of
from irsim.graphics.scene.groups import ranges_between
from irsim.graphics.scene.scene import (
    NO_CIRCLE,
    SOLID,
    Circle,
    Group,
    Line,
    Look,
    Mark,
    Region,
    Sector,
    Segments,
    Spots,
    Stroke,
)
from irsim.graphics.scene.style import Color

__all__ = ["Batch", "Work", "paint", "prepare"]

_KNOWN_COLORS = 2048
_NO_INK = bytes(4)
_MAX_LEVEL = 255.0
_TRANSPARENT = (0.0, 0.0, 0.0, 0.0)


@dataclass(slots=True, eq=False)
class Batch:
    """Shapes that are painted with one call, as the painter takes them.

    Attributes:
        points, ranges, radii, closed: See :class:`irsim.graphics.scene.groups.Group`.
        looks, scale: The looks that inks and widths were made from, and points per metre.
        inks: (N, 2, 4) colours of fill and edge, 0..255.
        widths: (N,) widths of edges [pt].
        dashes: Lengths of dashes and gaps [pt]; none for solid lines.
    """

    points: Floats
    ranges: NDArray[np.int64]
    radii: Floats
    closed: bool
    looks: Sequence[Look]
    scale: float
    inks: NDArray[np.uint8]
    widths: Floats
    dashes: Sequence[float] = ()


Fit = Literal["any", "area", "line", "alone"]
Work = Batch | Mark
"""Marks that one call paints; a mark that does not fit into a batch stands alone."""


def prepare(
    items: Iterable[Mark | Group], points_per_metre: float, before: Sequence[Work] = ()
) -> tuple[list[Work], bool]:
    """Sort marks into batches, in their order.

    Args:
        items: Marks and groups.
        points_per_metre: Scale of the view, for line widths given in metres.
        before: The result for the same layer in the last frame, whose colours may serve again.

    Returns:
        The batches and single marks, and whether all can be painted, which holds unless one has too many dashes.
    """
    work, run, paintable = list[Work](), list[Mark](), True
    kind: Fit = "any"

    def end_run() -> None:
        nonlocal kind
        if run:
            work.append(_batch_of_marks(run, kind != "line", points_per_metre))
            run.clear()
        kind = "any"

    for item in items:
        if isinstance(item, Group):
            end_run()
            batch = _batch_of_group(item, points_per_metre, before[len(work)] if len(work) < len(before) else None)
            paintable = paintable and batch is not None
            work += [] if batch is None else [batch]
            continue
        fit = _fit(item)
        if fit != "alone":
            if "any" not in (kind, fit) and kind != fit:
                end_run()
            kind = kind if fit == "any" else fit
            run.append(item)
            continue
        end_run()
        if item.stroke.style in SOLID:
            width = item.stroke.width * (points_per_metre if item.stroke.metric else 1.0)
            work.append(replace(item, stroke=replace(item.stroke, width=width, metric=False)))
        elif (dashed := _dashed(item, points_per_metre)) is not None:
            work += dashed
        else:
            paintable = False
    end_run()
    return work, paintable


def _fit(mark: Mark) -> Fit:
    """The batches that a mark fits into: of areas, of lines, of any shapes, or `alone`."""
    shape = mark.geometry
    if mark.stroke.style not in SOLID or mark.glow is not None:
        return "alone"
    if isinstance(shape, Circle | Spots):
        return "any"
    if isinstance(shape, Region) and len(shape.rings) == 1:
        return "area"
    return "line" if isinstance(shape, Segments) or (isinstance(shape, Line) and mark.fill is None) else "alone"


def _dashed(mark: Mark, points_per_metre: float) -> list[Work] | None:
    """The fill and the dashed outline of a mark; None if it cannot be painted."""
    points = outline(mark)
    dashes = None if points is None else pattern_of(mark.stroke, points, points_per_metre)
    if points is None or dashes is None:
        return None
    line = _batch_of_marks([replace(mark, geometry=Line(points), fill=None)], False, points_per_metre)
    line.dashes = dashes
    if mark.fill is None or not isinstance(mark.geometry, Region):
        return [line]
    return [_batch_of_marks([replace(mark, stroke=Stroke(None))], True, points_per_metre), line]


def _batch_of_group(group: Group, points_per_metre: float, before: Work | None) -> Batch | None:
    """The batch of a group; None if its lines have dashes that cannot be painted."""
    looks, stroke, dashes = group.looks, group.looks[0][1], list[float]()
    if stroke.style not in SOLID:
        pattern = pattern_of(stroke, group.points, points_per_metre, len(looks))
        if pattern is None:
            return None
        dashes = pattern
    if isinstance(before, Batch) and before.looks == looks and before.scale == points_per_metre:
        inks, widths = before.inks, before.widths
    else:
        inks, widths = _inks(looks), _widths(looks, points_per_metre)
    return Batch(group.points, group.ranges, group.radii, group.closed, looks, points_per_metre, inks, widths, dashes)


def _batch_of_marks(marks: Sequence[Mark], closed: bool, points_per_metre: float) -> Batch:
    chunks, sizes, radii, looks = list[Any](), list[int](), list[float](), list[Look]()
    for mark in marks:
        shape, look = mark.geometry, (mark.fill, mark.stroke, mark.alpha)
        if isinstance(shape, Circle):
            chunks.append(((shape.x, shape.y),))
            sizes.append(1)
            radii.append(max(shape.radius, 0.0))
            looks.append(look)
            continue
        assert not isinstance(shape, Sector)
        points = shape.rings[0] if isinstance(shape, Region) else shape.points
        many = len(points) if isinstance(shape, Segments | Spots) else 1
        chunks.append(points.reshape(-1, 2))
        sizes += [len(chunks[-1]) // max(many, 1)] * many
        radii += [shape.radius if isinstance(shape, Spots) else NO_CIRCLE] * many
        looks += [look] * many
    ranges = ranges_between(np.cumsum([0, *sizes]))
    points = np.concatenate(chunks, dtype=np.float64)
    inks, widths = _inks(looks), _widths(looks, points_per_metre)
    return Batch(points, ranges, np.array(radii, dtype=np.float64), closed, looks, points_per_metre, inks, widths)


def _widths(looks: Sequence[Look], points_per_metre: float) -> Floats:
    widths = [stroke.width * (points_per_metre if stroke.metric else 1.0) for _, stroke, _ in looks]
    return np.array(widths, dtype=np.float64)


def _inks(looks: Sequence[Look]) -> NDArray[np.uint8]:
    levels = b"".join([_ink(fill, alpha) + _ink(stroke.color, alpha) for fill, stroke, alpha in looks])
    return np.frombuffer(levels, dtype=np.uint8).reshape(-1, 2, 4)


def _ink(color: Color | None, alpha: float) -> bytes:
    if color is None:
        return _NO_INK
    return _known_levels(color, alpha) if isinstance(color, str) and color[:1] == "#" else _levels(color, alpha)


def _levels(color: Color, alpha: float) -> bytes:
    return bytes(int(min(1.0, max(0.0, level)) * _MAX_LEVEL + 0.5) for level in rgba(color, alpha))


_known_levels = lru_cache(maxsize=_KNOWN_COLORS)(_levels)


def paint(
    canvas: Canvas, target: tuple[NDArray[np.uint8], Any], ax: Any, work: Iterable[Work], ends: tuple[str, str]
) -> None:
    """Paint batches and marks.

    Args:
        canvas: The canvas, which tells the view and notes what was painted.
        target: Pixels to paint into, of the size of the canvas, and the Agg renderer that they belong to.
        ax: Axes in world coordinates, which cut the marks.
        work: Batches and marks, as :func:`prepare` returns it.
        ends: Styles of caps and joins of strokes.
    """
    pixels, renderer = target
    painter, per_point = canvas.painter, canvas.px_per_point
    for one in work:
        if isinstance(one, Batch):
            painter.shapes(
                pixels, one.points, one.ranges, one.radii, one.inks, one.widths * per_point, one.closed,
                ends[1], ends[0] == "round", [length * per_point for length in one.dashes],
            )  # fmt: skip
        elif one.glow is not None and isinstance(one.geometry, Region):
            assert one.fill is not None
            painter.glow(pixels, one.geometry.rings[0], *one.glow, rgba(one.fill, one.alpha))
        else:
            canvas.unknown = True
            _draw(renderer, ax, one, ends)


def _draw(renderer: Any, ax: Any, mark: Mark, ends: tuple[str, str]) -> None:
    """Let Agg draw a mark."""
    stroke, fill = mark.stroke, mark.fill
    context = renderer.new_gc()
    context.set_clip_rectangle(ax.bbox)
    context.set_capstyle(ends[0])
    context.set_joinstyle(ends[1])
    context.set_foreground(_TRANSPARENT if stroke.color is None else rgba(stroke.color, mark.alpha), isRGBA=True)
    context.set_linewidth(stroke.width if stroke.color is not None else 0.0)
    renderer.draw_path(
        context,
        geometry_path(mark.geometry),
        ax.transData.frozen(),
        None if fill is None else rgba(fill, mark.alpha),
    )
    context.restore()
