"""Places labels so that none covers another: beside, below or above the thing that they name, deterministically."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import bounds, picture_outline
from irsim.graphics.scene.scene import Bounds, Scene

__all__ = ["free_places", "small_bodies"]

_COST_OF_PLACED_LABEL = 1000.0
"""Cost of covering a label that has been placed."""
_COST_OF_LATER_LABEL = 30.0
"""Cost of covering the preferred place of a label that has not been placed."""
_COST_OF_BODY = 10.0
"""Cost of covering a body."""
_COST_OF_NEXT_CHOICE = 1.0
"""Cost of each place that comes later in the list of choices."""

_AVOIDED_PARTS = ("body", "goal", "arrow")
MAX_AVOIDED_SHARE = 0.2
"""Labels may cover bodies that are longer than this share of the picture."""

MAX_LABELS = 300
"""If there are more labels, all stay in place: they cannot be read anyway, and placing them takes long."""


def free_places(
    boxes: Floats, anchors: Floats, view: Floats, bodies: Callable[[], Floats], *, clear: bool = True
) -> Floats:
    """Find a place for each label, in the order given; labels that cover nothing stay in place.

    Args:
        boxes: (N, 4) left, bottom, right, top of each label at its preferred place [px].
        anchors: (N, 2) position of the thing that each label names [px].
        view: (4,) box that labels must not leave [px].
        bodies: Returns the (K, 4) boxes that labels should not cover [px].
        clear: Also move labels that cover one of these boxes, not only those that cover another label.

    Returns:
        (N, 2) shift of each label [px].
    """
    wanted = boxes + _shift_into_view(boxes, view)
    if len(wanted) > MAX_LABELS or not (clear or _overlaps(wanted, wanted).sum() > len(wanted)):
        moves: Floats = wanted[:, :2] - boxes[:, :2]
        return moves
    placed, taken = wanted.copy(), bodies()
    for i, box in enumerate(wanted):
        if not (_overlaps(box[None], placed[:i]).any() or (clear and _overlaps(box[None], taken).any())):
            continue
        choices = _choices(boxes[i], anchors[i])
        choices += _shift_into_view(choices, view)
        cost = (
            _COST_OF_PLACED_LABEL * _overlaps(choices, placed[:i]).sum(axis=1)
            + _COST_OF_LATER_LABEL * _overlaps(choices, placed[i + 1 :]).sum(axis=1)
            + _COST_OF_BODY * _overlaps(choices, taken).sum(axis=1)
            + _COST_OF_NEXT_CHOICE * np.arange(len(choices))
        )
        placed[i] = choices[int(cost.argmin())]
    found: Floats = placed[:, :2] - boxes[:, :2]
    return found


def small_bodies(scene: Scene) -> list[Bounds]:
    """Return left, bottom, right, top of the bodies, goals and arrows that labels should not cover [m]."""
    x0, x1, y0, y1 = scene.extent
    max_side = MAX_AVOIDED_SHARE * max(x1 - x0, y1 - y0)
    boxes = [bounds(mark.geometry) for mark in scene.marks if mark.part in _AVOIDED_PARTS]
    boxes += [bounds(picture_outline(picture)) for picture in scene.pictures]
    return [box for box in boxes if max(box[2] - box[0], box[3] - box[1]) < max_side]


def _choices(box: Floats, anchor: Floats) -> Floats:
    """List (C, 4) places for a label around its anchor; the preferred place comes first.

    The others are as far from the anchor as the preferred one. If that distance exceeds the size of the label, the
    named body is large, and a place inside it comes second.
    """
    left, bottom, right, top = box.tolist()
    (x, y), width, height = anchor.tolist(), right - left, top - bottom
    aside, above = max(abs(left - x), 1.0), max(abs(bottom - y), 1.0)
    lower = y - above - height
    corners = [
        (left, bottom),
        (x + aside, y - height / 2),
        (left, lower),
        (x - aside - width, y - height / 2),
        (x + aside, bottom),
        (x - aside - width, bottom),
        (x + aside, lower),
        (x - aside - width, lower),
        (left, bottom + height),
        (left, lower - height),
        (x + aside, bottom + height),
        (x + aside, lower - height),
        (left, bottom + 2 * height),
        (left, lower - 2 * height),
    ]
    if aside > width and above > height:
        corners.insert(1, (x - width / 2, y - height / 2))
    low = np.array(corners)
    return np.concatenate([low, low + np.array([width, height])], axis=1)


def _shift_into_view(boxes: Floats, view: Floats) -> Floats:
    """Return (N, 4) shifts that bring boxes into the view; a box that is too large starts at its lower left corner."""
    low, high = boxes[:, :2], boxes[:, 2:]
    back: Floats = np.where(high > view[2:], view[2:] - high, 0.0)
    shift: Floats = np.where(low + back < view[:2], view[:2] - low, back)
    return np.concatenate([shift, shift], axis=1)


def _overlaps(some: Floats, others: Floats) -> Floats:
    """Return (N, M) 1 where two boxes overlap, else 0."""
    a, b = some[:, None], others[None]
    apart = (a[..., 2:] <= b[..., :2]) | (a[..., :2] >= b[..., 2:])
    overlapping: Floats = np.asarray(~np.any(apart, axis=2), dtype=np.float64)
    return overlapping
