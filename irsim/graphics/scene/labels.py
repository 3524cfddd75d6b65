"""Places labels so that none covers another: close to the thing that they name, always in the same way."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import compress

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import bounds, picture_outline
from irsim.graphics.scene.scene import Bounds, Scene

__all__ = ["bodies_by_size", "free_places", "leader"]

_COST_OF_PLACED_LABEL = 1000.0
"""Cost of covering a label that has been placed."""
_COST_OF_LATER_LABEL = 4.0
"""Cost of covering the preferred place of a label that has not been placed."""
_COST_OF_BODY = 10.0
"""Cost of covering a body."""
_COST_OF_WALL = 5.0
"""Cost of covering a body that is longer than :data:`MAX_AVOIDED_SHARE`, such as a wall."""
_COST_OF_DISTANCE = 6.0
"""Cost of one height of the label as distance from the thing that it names."""
_COST_OF_NEXT_CHOICE = 0.1
"""Cost of each place that comes later in the list of choices, so that equal places are taken in that order."""

_GAP_PX = 2.0
"""Space between a label and the thing that it stands beside [px]."""
_DISTANCES = (0.0, 0.75, 1.75, 3.0, 4.5)
"""Distances from the thing at which places are tried, in heights of the label."""
_CLOSE = 2
"""Number of distances that are tried first; the others only if no place there is cheaper than any farther away."""
MAX_GAP_WITHOUT_LEADER = 0.6
"""A label farther away from its thing than this many heights of the label has a line to it."""

_AVOIDED_PARTS = ("body", "goal", "arrow")
MAX_AVOIDED_SHARE = 0.2
"""Bodies longer than this share of the picture are walls, which labels avoid less than other bodies."""

MAX_LABELS = 300
"""If there are more labels, all stay in place: they cannot be read anyway, and placing them takes long."""


def free_places(
    boxes: Floats, things: Floats, view: Floats, bodies: Callable[[], tuple[Floats, Floats]], *, clear: bool = True
) -> Floats:
    """Find a place for each label, in the order given; labels that cover nothing stay in place.

    Args:
        boxes: (N, 4) left, bottom, right, top of each label at its preferred place [px].
        things: (N, 4) box of the thing that each label names [px].
        view: (4,) box that labels must not leave [px].
        bodies: Returns the boxes that labels should not cover [px]: (K, 4) of small bodies, (W, 4) of walls.
        clear: Also move labels that cover one of these boxes, not only labels that cover another one.

    Returns:
        (N, 2) shift of each label [px].
    """
    wanted = boxes + _shift_into_view(boxes, view)
    if len(wanted) > MAX_LABELS or not (clear or _overlaps(wanted, wanted).sum() > len(wanted)):
        moves: Floats = wanted[:, :2] - boxes[:, :2]
        return moves
    placed, (small, walls) = wanted.copy(), bodies()
    for i, box in enumerate(wanted):
        barriers = _barriers(walls, things[i], box)
        avoided = [placed[:i], small, barriers] if clear else [placed[:i]]
        if not any(_overlaps(box[None], others).any() for others in avoided):
            continue
        for distances in (_DISTANCES[:_CLOSE], _DISTANCES):
            choices = _choices(boxes[i], things[i], distances)
            choices += _shift_into_view(choices, view)
            cost = (
                _COST_OF_PLACED_LABEL * _overlaps(choices, placed[:i]).sum(axis=1)
                + _COST_OF_LATER_LABEL * _overlaps(choices, placed[i + 1 :]).sum(axis=1)
                + _COST_OF_BODY * _overlaps(choices, small).sum(axis=1)
                + _COST_OF_WALL * _overlaps(choices, barriers).sum(axis=1)
                + _COST_OF_DISTANCE * _distances(choices, things[i])
                + _COST_OF_NEXT_CHOICE * np.arange(len(choices))
            )
            placed[i] = choices[int(cost.argmin())]
            if cost.min() <= _COST_OF_DISTANCE * _DISTANCES[_CLOSE]:
                break
    result: Floats = placed[:, :2] - boxes[:, :2]
    return result


def leader(box: Floats, thing: Floats) -> Floats | None:
    """Return the line that connects a label with the thing that it names, if it stands away from it.

    Args:
        box: (4,) left, bottom, right, top of the label [px].
        thing: (4,) box of the thing [px].

    Returns:
        (2, 2) points at the label and at the edge of the ellipse in the box of the thing [px], or None.
    """
    if float(_distances(box[None], thing)[0]) <= MAX_GAP_WITHOUT_LEADER:
        return None
    middle, half = (thing[:2] + thing[2:]) / 2, np.maximum((thing[2:] - thing[:2]) / 2, 1e-6)
    start = np.clip(middle, box[:2], box[2:])
    direction = (start - middle) / half
    return np.stack([start, middle + half * direction / max(1.0, float(np.hypot(*direction)))])


def bodies_by_size(scene: Scene) -> tuple[list[Bounds], list[Bounds]]:
    """Return left, bottom, right, top of what labels should not cover: bodies, goals and arrows, and walls [m]."""
    x0, x1, y0, y1 = scene.extent
    max_side = MAX_AVOIDED_SHARE * max(x1 - x0, y1 - y0)
    boxes = [bounds(mark.geometry) for mark in scene.marks if mark.part in _AVOIDED_PARTS]
    boxes += [bounds(picture_outline(picture)) for picture in scene.pictures]
    small = [max(box[2] - box[0], box[3] - box[1]) < max_side for box in boxes]
    return list(compress(boxes, small)), [box for box, is_small in zip(boxes, small, strict=True) if not is_small]


def _barriers(walls: Floats, thing: Floats, box: Floats) -> Floats:
    """Return the walls that a label should not cover: not the room around its thing, nor a thing it fits into."""
    middle = (thing[:2] + thing[2:]) / 2
    around = np.all((walls[:, :2] <= middle) & (middle <= walls[:, 2:]), axis=1)
    narrow = np.any(walls[:, 2:] - walls[:, :2] < box[2:] - box[:2], axis=1)
    kept: Floats = walls[~around | narrow]
    return kept


def _choices(box: Floats, thing: Floats, distances: Sequence[float]) -> Floats:
    """List (C, 4) places for a label around the thing that it names; the preferred place comes first.

    A label of a thing larger than itself may also stand inside of it.
    """
    width, height = (box[2:] - box[:2]).tolist()
    left, bottom, right, top = thing.tolist()
    x, y = (left + right) / 2, (bottom + top) / 2
    corners = [(float(box[0]), float(box[1]))]
    if right - left > 2 * width and top - bottom > 2 * height:
        corners.append((x - width / 2, y - height / 2))
    for distance in distances:
        away = distance * height
        diagonal = away / math.sqrt(2)
        over, under = top + away, bottom - height - away
        east, west = right + _GAP_PX + away, left - _GAP_PX - width - away
        corners += [(left, over), (east, y - height / 2), (west, y - height / 2), (left, under)]
        corners += [(x - width / 2, over), (x - width / 2, under), (right - width, over), (right - width, under)]
        for across in (right + _GAP_PX + diagonal, left - _GAP_PX - width - diagonal):
            corners += [(across, top + diagonal), (across, bottom - height - diagonal)]
    low = np.array(corners)
    return np.concatenate([low, low + np.array([width, height])], axis=1)


def _distances(boxes: Floats, thing: Floats) -> Floats:
    """Return (N,) distances between labels and a thing, in heights of the label."""
    apart = np.maximum(np.maximum(boxes[:, :2] - thing[2:], thing[:2] - boxes[:, 2:]) - _GAP_PX, 0.0)
    distances: Floats = np.hypot(apart[:, 0], apart[:, 1]) / (boxes[:, 3] - boxes[:, 1])
    return distances


def _shift_into_view(boxes: Floats, view: Floats) -> Floats:
    """Return (N, 4) shifts that bring boxes into the view; a box that is too large starts at its lower left corner."""
    low, high = boxes[:, :2], boxes[:, 2:]
    back: Floats = np.where(high > view[2:], view[2:] - high, 0.0)
    shift: Floats = np.where(low + back < view[:2], view[:2] - low, back)
    return np.concatenate([shift, shift], axis=1)


def _overlaps(some: Floats, others: Floats) -> Floats:
    """Return (N, M) 1 where two boxes overlap, else 0."""
    left, bottom, right, top = some.T[:, :, None]
    others = others.T[:, None]
    overlapping: Floats = ((right > others[0]) & (left < others[2]) & (top > others[1]) & (bottom < others[3])).astype(
        float
    )
    return overlapping
