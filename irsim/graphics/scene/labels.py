"""Where labels go so that none covers another: beside, below or above what they name, the same way every time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from irsim.graphics.scene.bodies import bounds, picture_outline
from irsim.graphics.scene.scene import Bounds, Floats, Scene

__all__ = ["free_places", "small_bodies"]

_ON_LABEL, _ON_LATER, _ON_BODY, _LATER_CHOICE = 1000.0, 30.0, 10.0, 1.0
"""Cost of covering a label that has its place, one that would like to have it, or a body; and of each next choice."""

_CLEAR = ("body", "goal", "arrow")
_LARGE = 0.2
"""Bodies longer than this share of the picture may be covered by labels."""

_MOST = 300
"""Labels beyond this stay where they are: nobody reads them."""


def free_places(
    boxes: Floats, anchors: Floats, view: Floats, bodies: Callable[[], Floats], *, clear: bool = True
) -> Floats:
    """Find a place for each label, earlier ones first; those that cover nothing stay.

    Args:
        boxes: (N, 4) left, bottom, right, top of the labels where they would like to be [px].
        anchors: (N, 2) what they name [px].
        view: (4,) labels are kept inside of this [px].
        bodies: Tells the (K, 4) boxes that labels had better not cover [px].
        clear: Move labels that cover one of these, too, not only those that cover a label.

    Returns:
        (N, 2) how far each label is to be moved [px].
    """
    wanted = boxes + _inwards(boxes, view)
    if len(wanted) > _MOST or not (clear or _meet(wanted, wanted).sum() > len(wanted)):
        moves: Floats = wanted[:, :2] - boxes[:, :2]
        return moves
    placed, taken = wanted.copy(), bodies()
    for i, box in enumerate(wanted):
        if not (_meet(box[None], placed[:i]).any() or (clear and _meet(box[None], taken).any())):
            continue
        choices = _choices(boxes[i], anchors[i])
        choices += _inwards(choices, view)
        cost = (
            _ON_LABEL * _meet(choices, placed[:i]).sum(axis=1)
            + _ON_LATER * _meet(choices, placed[i + 1 :]).sum(axis=1)
            + _ON_BODY * _meet(choices, taken).sum(axis=1)
            + _LATER_CHOICE * np.arange(len(choices))
        )
        placed[i] = choices[int(cost.argmin())]
    found: Floats = placed[:, :2] - boxes[:, :2]
    return found


def small_bodies(scene: Scene) -> list[Bounds]:
    """Left, bottom, right, top of what labels had better not cover [m]."""
    x0, x1, y0, y1 = scene.extent
    most = _LARGE * max(x1 - x0, y1 - y0)
    boxes = [bounds(mark.geometry) for mark in scene.marks if mark.part in _CLEAR]
    boxes += [bounds(picture_outline(picture)) for picture in scene.pictures]
    return [box for box in boxes if max(box[2] - box[0], box[3] - box[1]) < most]


def _choices(box: Floats, anchor: Floats) -> Floats:
    """(C, 4) places round what a label names, as far from it as the wanted one (first) is, or in it if it is large."""
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


def _inwards(boxes: Floats, view: Floats) -> Floats:
    """(N, 4) shifts that bring boxes into the view; its left and lower edge win where it is too small."""
    low, high = boxes[:, :2], boxes[:, 2:]
    back: Floats = np.where(high > view[2:], view[2:] - high, 0.0)
    shift: Floats = np.where(low + back < view[:2], view[:2] - low, back)
    return np.concatenate([shift, shift], axis=1)


def _meet(some: Floats, others: Floats) -> Floats:
    """(N, M) whether boxes overlap, as numbers."""
    a, b = some[:, None], others[None]
    apart = (a[..., 2:] <= b[..., :2]) | (a[..., :2] >= b[..., 2:])
    meeting: Floats = np.asarray(~np.any(apart, axis=2), dtype=np.float64)
    return meeting
