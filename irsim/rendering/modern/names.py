"""Places for names and times: beside their thing, over nothing that must be seen, always chosen in the same way."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from irsim import _core as core
from irsim.common.arrays import Floats
from irsim.graphics.figure.measuring import TextSizes
from irsim.graphics.scene.bodies import bounds
from irsim.graphics.scene.glyphs import CROWD, NAME
from irsim.graphics.scene.groups import boxes_of
from irsim.graphics.scene.scene import Bounds, Circle, Group, Label, Line, Mark
from irsim.graphics.scene.theme import Theme
from irsim.rendering.modern.frame import FRAME, label, stroke
from irsim.rendering.modern.layout import Layout
from irsim.rendering.modern.things import Crowd, Thing
from irsim.simulation.events import Event

__all__ = ["Wish", "place_names", "wishes_of"]

_NAME_Z, _LEADER_Z = 7.0, 6.5
PLACES_AROUND = 8
"""Number of places around a thing, at each of three distances; a line leads to the farther ones."""
_LEADER = 0.9
_ASCENT, _DESCENT = 0.76, 0.22
"""Height of a text above and below its line, as shares of its size."""
_TAKEN = ("goal", "contact", "badge", "head", "ring")
_MOVING_Z = 4.0
"""Bodies from this layer on are robots, people and other things that move."""
_LEAST_LINE_Z = 2.3
"""Lines of lower layers, which are trails of people, may be under names."""


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


def wishes_of(things: Sequence[Thing], own: Sequence[Event], crowd: Crowd, layout: Layout, theme: Theme) -> list[Wish]:
    """Names and times of contacts, the most important first."""
    star = layout.metres(layout.sizes.star)
    level = crowd.level
    named = [thing for thing in things if _has_name(thing, level)]
    first = [thing.picked or thing.state == "collided" for thing in named]
    wishes = [_name_wish(thing) for thing in compress(named, first)]
    short = level > 0  # colours repeat, so that robots need a name, and full ones have no room
    if level < 2 and len(own) <= CROWD["timed"]:
        for number, event in enumerate(own):
            place, text = (float(event.x), float(event.y)), f"{event.time:.1f} s"
            wishes.append(Wish(FRAME - number, "moment", text, theme.danger, place, (star, star), False))
    return wishes + [_name_wish(thing, short=short) for thing, early in zip(named, first, strict=True) if not early]


def _has_name(thing: Thing, level: int) -> bool:
    if not thing.shown:
        return False
    if thing.kind != "robot":
        chosen = "show_text" in thing.chosen and thing.view.shape != "walls"
        return chosen and thing.wants("show_text", False)
    return (level < 2 or thing.picked) and thing.wants("show_text")


def _name_wish(thing: Thing, *, short: bool = False) -> Wish:
    """The name of a thing; of a robot without one of its own ``robot_13``, or short ``r13``."""
    view, drawing = thing.view, thing.view.drawing
    text = (
        (drawing.label if short or view.record.is_named else view.name) if drawing.text is None else str(drawing.text)
    )
    shape = Circle(*thing.drawn_at[:2], thing.body.radius) if thing.mark is None else thing.mark.geometry
    left, bottom, right, top = bounds(shape)
    reach = max((right - left) / 2, thing.glyph_radius), max((top - bottom) / 2, thing.glyph_radius)
    if not thing.is_round and thing.glyph_radius <= thing.body.radius:
        reach = (right - left) / 2, (top - bottom) / 2
    return Wish(thing.number, "name", text, thing.shades.name, ((left + right) / 2, (bottom + top) / 2), reach)


def place_names(
    wishes: Sequence[Wish],
    marks: Sequence[Mark],
    groups: Sequence[Group],
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
        groups: More of them.
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
    taken = [box for mark, box in known.items() if mark.part in _TAKEN or mark.zorder >= _MOVING_Z]
    taken += [_text_box(one, layout, sizes) for one in fixed]
    walls = [box for mark, box in known.items() if mark.part == "body" and mark.zorder < _MOVING_Z]
    moving = boxes_of([group for group in groups if group.part in _TAKEN or group.part == "body"])
    plans, ranges = _lines(marks, groups, "plan", layout)
    trails, _ = _lines(marks, groups, "trajectory", layout)
    x0, x1, y0, y1 = layout.world
    (left, bottom), (right, top) = layout.place(x0, y0), layout.place(x1, y1)
    size = layout.sizes.name
    scale, heights = layout.scale, (_ASCENT + _DESCENT) * size
    needed = [
        (
            *layout.place(*wish.at), wish.reach[0] * scale, wish.reach[1] * scale,
            sizes.width(wish.text, size, bold=True),
        )
        for wish in wishes
    ]  # fmt: skip
    placed = core.place_names(
        np.array(needed, dtype=np.float64),
        heights,
        (left + 1, bottom + 1, right - 1, top - 1),
        np.concatenate([np.array(taken).reshape(-1, 4), layout.places(moving.reshape(-1, 2)).reshape(-1, 4)]),
        np.array(walls).reshape(-1, 4),
        plans,
        ranges,
        trails,
    )
    leaders, labels, halo = list[Mark](), list[Label](), (theme.paper, NAME["halo"])
    for wish, (number, *box) in zip(wishes, placed, strict=True):
        if number < 0:
            continue
        place = layout.at(box[0], box[1] + _DESCENT * size)
        labels.append(
            label(wish.number, wish.part, place, wish.text, wish.color, size, zorder=_NAME_Z, bold=True, halo=halo)
        )
        if wish.leads and number >= PLACES_AROUND:
            leaders.append(_leader(wish, np.array(box), layout))
    return leaders, labels, len(wishes) - len(labels)


def _leader(wish: Wish, box: Floats, layout: Layout) -> Mark:
    """A thin line from a text to the rim of its thing."""
    middle = layout.places(np.array([wish.at]))[0]
    half = np.maximum(np.array(wish.reach) * layout.scale, 1e-6)
    start = np.clip(middle, box[:2], box[2:])
    way = (start - middle) / half
    end = middle + half * way / max(1.0, float(np.hypot(*way)))
    points = np.array([layout.at(*start.tolist()), layout.at(*end.tolist())])
    return Mark(wish.number, "sign", Line(points), None, stroke(wish.color, _LEADER), 1.0, _LEADER_Z)


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


def _lines(
    marks: Sequence[Mark], groups: Sequence[Group], part: str, layout: Layout
) -> tuple[Floats, NDArray[np.int64]]:
    """Points of lines [u], and the first and the end of the points of each."""
    points, ranges, count = list[Floats](), list[NDArray[np.int64]](), 0
    for mark in marks:
        if mark.part == part and mark.zorder >= _LEAST_LINE_Z and isinstance(mark.geometry, Line):
            points.append(mark.geometry.points)
            ranges.append(np.array([(0, len(points[-1]))]) + count)
            count += len(points[-1])
    for group in groups:
        if group.part == part and group.zorder >= _LEAST_LINE_Z:
            points.append(group.points)
            ranges.append(group.ranges + count)
            count += len(group.points)
    if not points:
        return np.empty((0, 2)), np.empty((0, 2), dtype=np.int64)
    return layout.places(np.concatenate(points)), np.concatenate(ranges)
