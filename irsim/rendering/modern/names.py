"""Places for names and times: beside their thing, over nothing that must be seen, always chosen in the same way."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.glyphs import NAME
from irsim.graphics.scene.scene import Bounds, Label, Line, Mark
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern.frame import label, stroke
from irsim.rendering.modern.layout import Layout

__all__ = ["Wish", "place_names"]

_NAME_Z, _LEADER_Z = 7.0, 6.5
_GAPS = (NAME["gap"], 14.0, 26.0)
"""Distances of a name from its thing [u]; the farther ones have a line to it."""
_GAP_COST = (0.0, 0.3, 0.6)
_WALL_COST, _PLAN_COST, _TRAIL_COST, _ORDER_COST = 0.15, 0.12, 0.06, 0.01
_LINE_COSTS = (("plan", _PLAN_COST), ("trajectory", _TRAIL_COST))
_PLACES = 8
"""Number of places around a thing, at each distance."""
_PLACE_COSTS = tuple(cost + _ORDER_COST * order for cost in _GAP_COST for order in range(_PLACES))
_LEADER = 0.9
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
        known: Boxes of the marks of the picture before with this layout [u]; boxes of these marks are added.

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
    taken = blocks + [_text_box(one, layout, sizes) for one in fixed]
    walls = [box for mark, box in known.items() if mark.part == "body" and not _is_moving(mark)]
    lines = [(cost, _points(marks, part, layout)) for part, cost in _LINE_COSTS]
    x0, x1, y0, y1 = layout.world
    (left, bottom), (right, top) = layout.places(np.array([(x0, y0), (x1, y1)])).tolist()
    inside = left + 1, bottom + 1, right - 1, top - 1
    leaders, labels, dropped = list[Mark](), list[Label](), 0
    size = layout.sizes.name
    for wish in wishes:
        best = _cheapest(
            _places(wish, layout, sizes.width(wish.text, size, bold=True), size), inside, taken, walls, lines
        )
        if best is None:
            dropped += 1
            continue
        chosen, box = best
        taken.append(box)
        place = layout.at(box[0], box[1] + _DESCENT * size)
        halo = (theme.paper, NAME["halo"])
        labels.append(
            label(wish.number, wish.part, place, wish.text, wish.color, size, zorder=_NAME_Z, bold=True, halo=halo)
        )
        if wish.leads and chosen >= _PLACES:
            leaders.append(_leader(wish, np.array(box), layout))
    return leaders, labels, dropped


def _cheapest(
    places: Iterable[Bounds],
    inside: Bounds,
    taken: Sequence[Bounds],
    walls: Sequence[Bounds],
    lines: Sequence[tuple[float, Floats]],
) -> tuple[int, Bounds] | None:
    """Number and box of the free place of least cost; a place that cannot be the cheapest is not looked at."""
    best: tuple[int, Bounds] | None = None
    least = math.inf, math.inf
    for number, (box, cost) in enumerate(zip(places, _PLACE_COSTS, strict=True)):
        if cost >= least[0]:
            break
        a, b, c, d = box
        if a < inside[0] or b < inside[1] or c > inside[2] or d > inside[3] or _meets(box, taken):
            continue
        cost += _WALL_COST * _meets(box, walls)
        whole = cost
        for price, points in lines if cost <= least[0] else ():
            whole += price * _holds(box, points)
        if (whole, cost) < least:
            best, least = (number, box), (whole, cost)
    return best


def _places(wish: Wish, layout: Layout, width: float, size: float) -> Iterator[Bounds]:
    """3 * 8 boxes around a thing, the nearest first: above, below, right, left, then the corners [u]."""
    x, y = layout.place(*wish.at)
    across, up = (length * layout.scale for length in wish.reach)
    height = (_ASCENT + _DESCENT) * size
    for gap in _GAPS:
        over, under = y + up + gap, y - up - gap - height
        right, left = x + across + gap, x - across - gap - width
        middle, half = x - width / 2, y - height / 2
        slant = 0.75
        corners = [(middle, over), (middle, under), (right, half), (left, half)]
        for side in (x + slant * across + gap * slant, x - slant * across - gap * slant - width):
            corners += [(side, y + slant * (up + gap)), (side, y - slant * (up + gap) - height)]
        yield from ((a, b, a + width, b + height) for a, b in corners)


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
    x, y = layout.place(one.x, one.y)
    width = sizes.width(one.text, size, bold=one.bold, italic=one.italic)
    return x, y - _DESCENT * size, x + width, y + _ASCENT * size


def _points(marks: Sequence[Mark], part: str, layout: Layout) -> Floats:
    """Points along lines, so close together that a text hardly lies between two of them [u]."""
    lines = [
        m.geometry.points for m in marks if m.part == part and m.zorder >= _LEAST_LINE_Z and type(m.geometry) is Line
    ]
    if not lines or part != "plan":
        return layout.places(np.concatenate([np.empty((0, 2)), *lines]))
    straight = layout.places(np.array([points for points in lines if len(points) == 2]).reshape(-1, 2))
    starts, ways = straight[::2], straight[1::2] - straight[::2]
    pieces = (np.hypot(ways[:, 0], ways[:, 1]) / _SPREAD).astype(int) + 1
    whose = np.repeat(np.arange(len(pieces)), pieces + 1)
    shares = (np.arange(len(whose)) - (np.cumsum(pieces + 1) - pieces - 1)[whose]) / pieces[whose]
    places = [starts[whose] + shares[:, None] * ways[whose]]
    for points in (layout.places(points) for points in lines if len(points) != 2):
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])  # corners are far apart
        at = np.linspace(0.0, along[-1], 2 + int(along[-1] / _SPREAD))
        places.append(np.stack([np.interp(at, along, points[:, k]) for k in (0, 1)], axis=1))
    return np.concatenate(places)


def _holds(box: Bounds, points: Floats) -> bool:
    """Whether a box contains one of the points."""
    inside = (points > box[:2]) & (points < box[2:])
    return bool((inside[:, 0] & inside[:, 1]).any())


def _meets(box: Bounds, others: Sequence[Bounds]) -> bool:
    """Whether a box overlaps another one."""
    left, bottom, right, top = box
    return any(right > a and left < c and top > b and bottom < d for a, b, c, d in others)
