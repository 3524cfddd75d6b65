"""The surroundings of a picture: paper, grid, edge of the world, coordinates, scale bar, and the page."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from irsim.graphics.scene.scene import Bounds, Label, Line, Mark, Region, Segments, Stroke
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern.layout import POINTS_PER_U, Layout, nice_length, nice_part

__all__ = ["FRAME", "axis_labels", "foot", "frame_marks", "grid_step", "ground_marks", "label", "stroke"]

FRAME = -5000
"""Numbers of marks and labels that belong to no object begin here, downwards."""
_EDGE = 1.2
_GRID_Z, _EDGE_Z, _PAGE_Z, TITLE_Z, _TEXT_Z = 0.1, 1.5, 7.5, 8.0, 8.1
_MAX_BAR_SHARE = 0.16
"""Greatest length of the scale bar, as a share of the width of the picture."""
_MIN_TICK = 40.0
"""Where lines of the grid are closer together, every second one has its coordinate [u]."""


@lru_cache(maxsize=1024)
def stroke(color: str | None, width: float, style: object = "-") -> Stroke:
    """A stroke with round ends; its width is in u."""
    return Stroke(color, width * POINTS_PER_U, style=style, round_caps=True)


def label(
    number: int,
    part: str,
    place: tuple[float, float],
    text: str,
    color: str,
    size: float,
    *,
    zorder: float = _TEXT_Z,
    bold: bool = False,
    italic: bool = False,
    halo: tuple[str, float] | None = None,
) -> Label:
    """A text at a place of the world [m]; its size and the width of its halo are in u."""
    outline = None if halo is None else (halo[0], halo[1] * POINTS_PER_U)
    return Label(number, part, *place, place, text, color, size * POINTS_PER_U, 1.0, zorder, bold, italic, outline)


def grid_step(layout: Layout) -> float:
    """Distance of two lines of the grid [m]."""
    return nice_length(layout.sizes.grid / layout.scale)


def lines_between(low: float, high: float, step: float) -> list[float]:
    """Multiples of a step between two values, without these."""
    first, last = math.floor(low / step) + 1, math.ceil(high / step) - 1
    return [number * step for number in range(first, last + 1)]


def ground_marks(layout: Layout, theme: Theme, *, walls: bool) -> list[Mark]:
    """Paper, grid and edge of the world."""
    x0, x1, y0, y1 = layout.world
    step, thin = grid_step(layout), stroke(theme.grid, 1.0)
    marks = [Mark(FRAME, "paper", rectangle(x0, y0, x1, y1), theme.paper, Stroke(None), 1.0, 0.0)]
    lines = [((x, y0), (x, y1)) for x in lines_between(x0, x1, step)]
    lines += [((x0, y), (x1, y)) for y in lines_between(y0, y1, step)]
    if lines:
        marks.append(Mark(FRAME, "grid", Segments(np.array(lines)), None, thin, 1.0, _GRID_Z))
    edge = stroke(theme.wall, layout.sizes.wall) if walls else stroke(theme.line, _EDGE)
    marks.append(Mark(FRAME, "paper", rectangle(x0, y0, x1, y1), None, edge, 1.0, _EDGE_Z))
    return marks


def frame_marks(layout: Layout, theme: Theme, *, walls: bool) -> list[Mark]:
    """The page over everything that reaches out of the world, in whole pixels."""
    x0, x1, y0, y1 = layout.world
    corners = layout.places(np.array([(x0, y0), (x1, y1)])) * layout.ratio
    out = (layout.sizes.wall if walls else _EDGE) / 2 * layout.ratio
    (x0, y0), (x1, y1) = np.floor(corners[0] - out), np.ceil(corners[1] + out)
    right, top = layout.size
    page = page_color(layout, theme)
    strips = [(0, 0, right, y0), (0, y1, right, top), (0, y0, x0, y1), (x1, y0, right, y1)]
    return [
        Mark(FRAME, "frame", _of_pixels(strip, layout), page, Stroke(None), 1.0, _PAGE_Z)
        for strip in strips
        if strip[0] < strip[2] and strip[1] < strip[3]
    ]


def _of_pixels(box: Bounds, layout: Layout) -> Region:
    left, bottom, right, top = (value / layout.ratio for value in box)
    return rectangle(*layout.at(left, bottom), *layout.at(right, top))


def page_color(layout: Layout, theme: Theme) -> str:
    """The colour around the world, which is white in print."""
    return "#ffffff" if layout.sizes.kind == "print" and theme.name == "light" else theme.page


def foot(layout: Layout, theme: Theme) -> tuple[list[Mark], list[Label]]:
    """The scale bar, with the step of the grid where that differs."""
    sizes, step = layout.sizes, grid_step(layout)
    length = nice_part(_MAX_BAR_SHARE * layout.width / layout.scale)
    low, tick = sizes.foot / 2 - sizes.foot_text * 0.4, sizes.foot_text * 0.4
    left = layout.left
    points = [(left, low + tick), (left, low), (left + length * layout.scale, low)]
    points.append((points[-1][0], low + tick))
    bar = Line(np.array([layout.at(*point) for point in points]))
    text = f"{length:g} m" + ("" if math.isclose(length, step) else f" (grid {step:g} m)")
    place = layout.at(points[-1][0] + 5, low)
    marks = [Mark(FRAME, "foot", bar, None, stroke(theme.muted, 1.4), 1.0, TITLE_Z)]
    return marks, [label(FRAME, "scale", place, text, theme.muted, sizes.foot_text)]


def axis_labels(layout: Layout, theme: Theme) -> list[Label]:
    """Coordinates of the lines of the grid, inside the lower and the left edge."""
    x0, x1, y0, y1 = layout.world
    step = grid_step(layout)
    step *= 1 if step * layout.scale >= _MIN_TICK else 2
    size, halo, labels = (9.0 if layout.sizes.kind == "small" else 10.0), (theme.paper, 2.0), []
    low, left = layout.metres(4), layout.metres(4)
    for number, x in enumerate(lines_between(x0, x1, step)):
        text = f"{x:g}"
        place = x - layout.metres(0.3 * size * len(text)), y0 + low
        if layout.metres(3 * size) < x - x0 and x + layout.metres(0.4 * size * len(text)) < x1:
            labels.append(label(FRAME - number, "x", place, text, theme.muted, size, zorder=_EDGE_Z, halo=halo))
    for number, y in enumerate(lines_between(y0, y1, step)):
        if y - y0 > layout.metres(1.6 * size) and y1 - y > layout.metres(size):
            place = x0 + left, y - layout.metres(0.36 * size)
            labels.append(label(FRAME - number, "y", place, f"{y:g}", theme.muted, size, zorder=_EDGE_Z, halo=halo))
    return labels


def rectangle(left: float, bottom: float, right: float, top: float) -> Region:
    """A rectangle, counter-clockwise."""
    return Region([np.array([(left, bottom), (right, bottom), (right, top), (left, top)], dtype=np.float64)])
