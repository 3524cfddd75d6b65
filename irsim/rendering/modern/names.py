"""Places for names and times: beside their thing, over nothing that must be seen, always chosen in the same way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.scene import Bounds, Label, Line, Mark
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern.frame import label, stroke
from irsim.rendering.modern.layout import Layout

__all__ = ["Wish", "place_names"]

_NAME_Z, _LEADER_Z = 7.0, 6.5
_GAPS = (4.0, 14.0, 26.0)
"""Distances of a name from its thing [u]; the farther ones have a line to it."""
_GAP_COST = (0.0, 0.3, 0.6)
_WALL_COST, _PLAN_COST, _TRAIL_COST, _ORDER_COST = 0.15, 0.12, 0.06, 0.01
_LINE_COSTS = (("plan", _PLAN_COST), ("trajectory", _TRAIL_COST))
_PLACES = 8
"""Number of places around a thing, at each distance."""
_PLACE_COSTS = np.repeat(_GAP_COST, _PLACES) + _ORDER_COST * np.tile(np.arange(_PLACES), len(_GAPS))
_HALO, _LEADER = 2.6, 0.9
_ASCENT, _DESCENT = 0.76, 0.22
"""Height of a text above and below its line, as shares of its size."""
_TAKEN = ("goal", "contact", "badge", "head", "ring")
_MOVING_Z = 4.0
"""Bodies from this layer on are robots, people and other things that move."""
_LEAST_LINE_Z = 2.3
"""Lines of lower layers, which are trails of people, may be under names."""
_SPREAD = 6.0
"""Distance of the points of plans that names avoid [u]."""


@dataclass(frozen=True)
class Wish:
    """A text that needs a place.

    Attributes:
        number, part: Object and part of the label.
        text: The text.
        color: Its colour.
        at: Middle of the thing [m].
        reach: Half the width and half the height of the thing [m].
        leads: Whether a line may lead to a text that stands away.
    """

    number: int
    part: str
    text: str
    color: str
    at: tuple[float, float]
    reach: tuple[float, float]
    leads: bool = True


def place_names(
    wishes: Sequence[Wish],
    marks: Sequence[Mark],
    fixed: Sequence[Label],
    layout: Layout,
    theme: Theme,
    sizes: TextSizes,
    known: dict[Mark, Bounds],
) -> tuple[list[Mark], list[Label], int]:
    """Find places for texts, the most important first.

    Args:
        wishes: The texts.
        marks: The marks of the picture.
        fixed: Texts that have their place.
        layout: The layout.
        theme: The colours.
        sizes: Measures texts.
        known: Boxes of the marks of the picture before with this layout [u]; it receives those of these marks.

    Returns:
        Lines to texts that stand away, the labels, and the number of texts without a place.
    """
    if not wishes:
        return [], [], 0
    before = dict(known)
    known.clear()
    for mark in marks:
        if mark.part in _TAKEN or mark.part == "body":
            box_before = before.get(mark)
            known[mark] = _box(mark, layout) if box_before is None else box_before
    blocks = [box for mark, box in known.items() if mark.part in _TAKEN or _is_moving(mark)]
    taken = np.array(blocks + [_text_box(one, layout, sizes) for one in fixed]).reshape(-1, 4)
    walls = np.array([box for m, box in known.items() if m.part == "body" and not _is_moving(m)]).reshape(-1, 4)
    lines = [(cost, _points(marks, part, layout)) for part, cost in _LINE_COSTS]
    x0, x1, y0, y1 = layout.world
    low, high = layout.places(np.array([(x0, y0), (x1, y1)]))
    leaders, labels, dropped = list[Mark](), list[Label](), 0
    size = layout.sizes.name
    for wish in wishes:
        width = sizes.width(wish.text, size, bold=True)
        places = _places(wish, layout, width, size)
        free = np.all((places[:, :2] >= low + 1) & (places[:, 2:] <= high - 1), axis=1)
        free &= ~_overlaps(places, taken).any(axis=1)
        if not free.any():
            dropped += 1
            continue
        cost = _PLACE_COSTS + _WALL_COST * _overlaps(places, walls).any(axis=1)
        chosen = _cheapest(places, np.where(free, cost, np.inf), lines)
        box = places[chosen]
        taken = np.concatenate([taken, box[None]])
        place = layout.at(float(box[0]), float(box[1]) + _DESCENT * size)
        halo = (theme.paper, _HALO)
        labels.append(
            label(wish.number, wish.part, place, wish.text, wish.color, size, zorder=_NAME_Z, bold=True, halo=halo)
        )
        if wish.leads and chosen >= _PLACES:
            leaders.append(_leader(wish, box, layout))
    return leaders, labels, dropped


def _cheapest(places: Floats, cost: Floats, lines: Sequence[tuple[float, Floats]]) -> int:
    """The place of least cost, with what it costs to lie over lines; dear places are not compared with lines."""
    chosen, least = 0, np.inf
    for number in np.argsort(cost, kind="stable").tolist():
        if cost[number] >= least:
            break
        whole = float(cost[number])
        for price, points in lines:
            whole += price * _holds(places[number], points)
        if whole < least:
            chosen, least = number, whole
    return chosen


def _places(wish: Wish, layout: Layout, width: float, size: float) -> Floats:
    """(3 * 8, 4) boxes around a thing, the nearest first: above, below, right, left, then the corners [u]."""
    [(x, y)] = layout.places(np.array([wish.at])).tolist()
    across, up = (length * layout.scale for length in wish.reach)
    height = (_ASCENT + _DESCENT) * size
    boxes = []
    for gap in _GAPS:
        over, under = y + up + gap, y - up - gap - height
        right, left = x + across + gap, x - across - gap - width
        middle, half = x - width / 2, y - height / 2
        slant = 0.75
        corners = [(middle, over), (middle, under), (right, half), (left, half)]
        for side in (x + slant * across + gap * slant, x - slant * across - gap * slant - width):
            corners += [(side, y + slant * (up + gap)), (side, y - slant * (up + gap) - height)]
        boxes += [(a, b, a + width, b + height) for a, b in corners]
    return np.array(boxes)


def _leader(wish: Wish, box: Floats, layout: Layout) -> Mark:
    """A thin line from a text to the rim of its thing."""
    middle = layout.places(np.array([wish.at]))[0]
    half = np.maximum(np.array(wish.reach) * layout.scale, 1e-6)
    start = np.clip(middle, box[:2], box[2:])
    way = (start - middle) / half
    end = middle + half * way / max(1.0, float(np.hypot(*way)))
    points = np.array([layout.at(*start.tolist()), layout.at(*end.tolist())])
    return Mark(wish.number, "sign", Line(points), None, stroke(wish.color, _LEADER), 1.0, _LEADER_Z)


def _is_moving(mark: Mark) -> bool:
    return mark.part == "body" and mark.zorder >= _MOVING_Z


def _box(mark: Mark, layout: Layout) -> Bounds:
    left, bottom, right, top = bounds(mark.geometry)
    x, y, scale = layout.world[0], layout.world[2], layout.scale
    return (
        (left - x) * scale + layout.left,
        (bottom - y) * scale + layout.bottom,
        (right - x) * scale + layout.left,
        (top - y) * scale + layout.bottom,
    )


def _text_box(one: Label, layout: Layout, sizes: TextSizes) -> tuple[float, float, float, float]:
    size = one.size * 96 / 72
    [(x, y)] = layout.places(np.array([(one.x, one.y)])).tolist()
    width = sizes.width(one.text, size, bold=one.bold, italic=one.italic)
    return x, y - _DESCENT * size, x + width, y + _ASCENT * size


def _points(marks: Sequence[Mark], part: str, layout: Layout) -> Floats:
    """Points along lines, so close together that a text hardly lies between two of them [u]."""
    lines = [
        m.geometry.points for m in marks if m.part == part and m.zorder >= _LEAST_LINE_Z and type(m.geometry) is Line
    ]
    if not lines or part != "plan":
        return layout.places(np.concatenate([np.empty((0, 2)), *lines]))
    places = list[Floats]()
    for points in map(layout.places, lines):
        if len(points) == 2:
            length = float(np.hypot(*(points[1] - points[0])))
            places.append(
                points[0] + np.linspace(0.0, 1.0, 2 + int(length / _SPREAD))[:, None] * (points[1] - points[0])
            )
            continue
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])  # corners are far apart
        at = np.linspace(0.0, along[-1], 2 + int(along[-1] / _SPREAD))
        places.append(np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1))
    return np.concatenate(places)


def _holds(box: Floats, points: Floats) -> bool:
    """Whether a box contains one of the points."""
    inside = (points > box[:2]) & (points < box[2:])
    return bool((inside[:, 0] & inside[:, 1]).any())


def _overlaps(some: Floats, others: Floats) -> NDArray[np.bool_]:
    left, bottom, right, top = some.T[:, :, None]
    a, b, c, d = others.T[:, None]
    overlapping: NDArray[np.bool_] = (right > a) & (left < c) & (top > b) & (bottom < d)
    return overlapping
