"""Recomputes the contacts of a recorded run: at the end of each step and, swept, within it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.runs.audit.artifact import Artifact
from irsim.runs.audit.shapes import TOLERANCE_M, Placed, Shape, gap, overlap
from irsim.runs.audit.strides import Strides

__all__ = ["Encounter", "Encounters", "Touch"]

Touch = Literal["no", "perhaps", "yes"]
"""Whether two bodies touch; ``perhaps``: within the tolerance."""
_SMALLEST_SHARE = 2.0**-24
"""Length of the intervals of a step that are not divided further."""
_MAX_LOOKS = 20_000
"""Number of poses within one step at which one pair is looked at."""
_MAX_ALL_LOOKS = 200_000
"""Number of such poses in a run, beyond which passages are not resolved."""
_SAMPLES = 48
"""Number of poses after a first contact at which it is looked whether the two overlap."""
_BLOCK_NUMBERS = 4_000_000
"""Number of values of the boxes of a block of steps."""
_MARGIN = np.array([-1.0, -1.0, 1.0, 1.0]) * TOLERANCE_M
"""Added to boxes, which then meet if bodies in them touch within the tolerance."""


@dataclass(frozen=True)
class Encounter:
    """Two bodies that come near each other in a step.

    Attributes:
        step: Step; 0 is the initial state.
        one, other: Indices of the bodies, the lower one first.
        before: Whether they touch at the beginning of the step.
        after: Whether they touch at its end.
        within: Whether they touch at any time in it, if they are apart at its beginning.
        time: When they first touch, as a share of the step; None if they do not, or touched before.
        gap: Smallest distance that was seen [m]; below 0 if circles overlap.
    """

    step: int
    one: int
    other: int
    before: Touch
    after: Touch
    within: Touch
    time: float | None
    gap: float


class Encounters:
    """Finds all encounters of a run.

    The gap between two bodies changes by at most the speed with which points of them approach each other. So an
    interval of a step without a contact is one whose two gaps together are larger than this speed times its length;
    others are halved, down to 2^-24 of the step.

    Args:
        artifact: The run.
        strides: Its motions.
        shapes: Its outlines.

    Attributes:
        unseen: Largest depth of an overlap that the smallest intervals may have hidden [m].
        unresolved: Number of pairs and steps that took too many looks.
    """

    def __init__(self, artifact: Artifact, strides: Strides, shapes: list[Shape]) -> None:
        self._artifact, self.strides, self._shapes = artifact, strides, shapes
        self._static = [body.options.static for body in artifact.bodies]
        self._free = [body.options.unobstructed for body in artifact.bodies]
        self._still = artifact.world.collision_mode == "contact"  # bodies that push each other move on unknown ways
        self._placed = dict[tuple[int, int], list[Placed]]()
        self._touch = dict[tuple[int, int, int], tuple[Touch, float]]()
        self.unseen = 0.0
        self.unresolved = self._looks = 0

    def all(self) -> Iterator[Encounter]:
        """The encounters, step by step."""
        rows = len(self._artifact.pose)
        yield from self._initial()
        count = max(1, len(self._shapes))
        block = max(1, _BLOCK_NUMBERS // (4 * count))
        reach = np.array([shape.reach for shape in self._shapes])
        boxes = self.strides.boxes(reach)
        for row, shape in enumerate(self._shapes):
            if self._static[row]:
                there = ~np.isnan(self._artifact.pose[1:, row, 0]) | shape.is_map
                pose = self._artifact.pose[-1, row]
                known = self._artifact.pose[there.argmax() + 1, row] if there.any() else pose
                boxes[:, row] = np.where(there[:, None], shape.box(known.tolist()), np.nan)
        for first in range(0, rows - 1, block):
            near = self._near(boxes[first : first + block])
            for step, one, other in near:
                yield self._encounter(first + step, one, other)

    def _initial(self) -> Iterator[Encounter]:
        present = [row for row in range(len(self._shapes)) if self._is_there(0, row)]
        boxes = {row: self._shapes[row].box(self._artifact.pose[0, row].tolist()) for row in present}
        for one, other in _meeting(boxes):
            touch, apart = self._at_end(0, one, other)
            if touch != "no":
                yield Encounter(self._artifact.first, one, other, "no", touch, touch, None, apart)

    def standing(self) -> Iterator[tuple[int, int, Touch, NDArray[np.bool_]]]:
        """Pairs of bodies that never move and touch: the two, how surely, and the (T,) rows in which both are there."""
        still = [row for row, static in enumerate(self._static) if static]
        there = {row: ~np.isnan(self._artifact.pose[:, row, 0]) | self._shapes[row].is_map for row in still}
        present = [row for row in still if there[row].any()]
        boxes = {row: self._shapes[row].box(self._artifact.pose[there[row].argmax(), row].tolist()) for row in present}
        for one, other in _meeting(boxes):
            both = there[one] & there[other]
            touch = self._at_end(int(both.argmax()), one, other)[0] if both.any() else "no"
            if touch != "no":
                yield one, other, touch, both

    def _near(self, boxes: Floats) -> list[tuple[int, int, int]]:
        """Step, and the two bodies whose boxes come near each other in it."""
        pairs = list[tuple[int, int, int]]()
        moving = [row for row, static in enumerate(self._static) if not static]
        low, high = boxes[..., :2] - 2 * TOLERANCE_M, boxes[..., 2:] + 2 * TOLERANCE_M
        for one in moving:
            meets = (low[:, one, None] <= high).all(axis=-1) & (low <= high[:, one, None]).all(axis=-1)
            for step, other in np.argwhere(meets).tolist():
                if other != one and (self._static[other] or other > one):
                    pairs.append((step, min(one, other), max(one, other)))
        return sorted(pairs)

    def _is_there(self, row: int, body: int) -> bool:
        return bool(self._shapes[body].is_map or not np.isnan(self._artifact.pose[row, body, 0]))

    def _body(self, row: int, body: int) -> list[Placed]:
        """A body at the end of a step."""
        key = (0 if self._static[body] else row, body)
        if key not in self._placed:
            if len(self._placed) > 4 * len(self._shapes) + 64:
                self._placed.clear()
            self._placed[key] = self._shapes[body].at(self._artifact.pose[row, body].tolist())
        return self._placed[key]

    def _at_end(self, row: int, one: int, other: int) -> tuple[Touch, float]:
        """Whether two bodies touch at the end of a step, and how far they are apart."""
        if not (self._is_there(row, one) and self._is_there(row, other)):
            return "no", np.inf
        key = (row, one, other)
        if key not in self._touch:
            if len(self._touch) > 100_000:
                self._touch.clear()
            self._touch[key] = _touch(self._body(row, one), self._body(row, other))
        return self._touch[key]

    def _encounter(self, row: int, one: int, other: int) -> Encounter:
        """The encounter of two bodies in the step from a row to the next one."""
        before, gap_before = self._at_end(row, one, other)
        after, gap_after = self._at_end(row + 1, one, other)
        step = self._artifact.first + row + 1
        whole = all(self._is_there(place, body) for place in (row, row + 1) for body in (one, other))
        within: Touch = "no" if before == "yes" else after
        if before == "yes" or not whole or self._still or self._free[one] or self._free[other]:
            return Encounter(step, one, other, before, after, within, None, min(gap_before, gap_after))
        if before == "perhaps":
            within = self._sure(row, one, other, 0.0)
            return Encounter(step, one, other, before, after, within, None, min(gap_before, gap_after))
        time, least = self._first_contact(row, one, other, gap_before, gap_after)
        if time is not None:
            within = self._sure(row, one, other, time)
        return Encounter(step, one, other, before, after, within, time, min(least, gap_after))

    def gap_at(self, row: int, one: int, other: int, time: float) -> float:
        """Distance between two bodies at a time within the step from a row to the next one [m]."""
        return gap(self._moved(row, one, time), self._moved(row, other, time))

    def overlap_at(self, row: int, one: int, other: int, time: float) -> bool:
        """Whether two bodies overlap by more than the tolerance at a time within a step."""
        return overlap(self._moved(row, one, time), self._moved(row, other, time))

    def _moved(self, row: int, body: int, time: float, onward: bool = False) -> list[Placed]:
        if self._static[body]:
            return self._body(row + 1, body)
        return self._shapes[body].at(self.strides.at(row, body, time, onward=onward))

    def _first_contact(self, row: int, one: int, other: int, begin: float, end: float) -> tuple[float | None, float]:
        """When two bodies come within the tolerance of each other, as a share of a step, and the smallest gap."""
        speed = self.strides.speed(row, one, other, (self._reach(one), self._reach(other)))
        least, looks = min(begin, end), 0
        most = max(1, min(_MAX_LOOKS, _MAX_ALL_LOOKS - self._looks))
        pending = [(0.0, 1.0, begin, end)]
        while pending:
            start, stop, at_start, at_stop = pending.pop()
            if at_start <= TOLERANCE_M and start > 0.0:
                return start, min(least, at_start)
            hidden = 0.5 * (speed * (stop - start) - at_start - at_stop)
            if hidden < -TOLERANCE_M:
                continue
            if stop - start <= _SMALLEST_SHARE or looks >= most:
                self.unseen = max(self.unseen, hidden)
                self.unresolved += looks >= most and stop - start > _SMALLEST_SHARE
                if at_stop <= TOLERANCE_M:
                    return stop, min(least, at_stop)
                continue
            middle = 0.5 * (start + stop)
            between = self.gap_at(row, one, other, middle)
            looks += 1
            self._looks += 1
            least = min(least, between)
            pending += [(middle, stop, between, at_stop), (start, middle, at_start, between)]
        return (1.0, least) if end <= TOLERANCE_M else (None, least)

    def _sure(self, row: int, one: int, other: int, time: float) -> Touch:
        """Whether bodies that touch at a time overlap afterwards, or would if no contact had stopped them."""
        shares = [time + (1.0 - time) * 0.5**power for power in range(24, 0, -1)]
        shares += np.linspace(time, 1.0, _SAMPLES).tolist()
        for share in shares:
            if self.overlap_at(row, one, other, share):
                return "yes"
        if min(self.strides.stop[row, one], self.strides.stop[row, other]) < 1.0:
            for share in shares:
                if overlap(self._moved(row, one, share, True), self._moved(row, other, share, True)):
                    return "yes"
        return "perhaps"

    def _reach(self, body: int) -> float:
        return 0.0 if self._static[body] else self._shapes[body].reach


def _meeting(boxes: Mapping[int, Floats]) -> list[tuple[int, int]]:
    """Pairs of bodies whose boxes meet, the lower index first."""
    rows = list(boxes)
    areas: Any = shapely.box(*(np.array([boxes[row] for row in rows]).reshape(-1, 4) + _MARGIN).T)
    pairs = shapely.STRtree(areas).query(areas, predicate="intersects").T.tolist()
    return sorted((rows[one], rows[other]) for one, other in pairs if one < other)


def _touch(some: list[Placed], others: list[Placed]) -> tuple[Touch, float]:
    apart = gap(some, others)
    if apart > TOLERANCE_M:
        return "no", apart
    return ("yes" if overlap(some, others) else "perhaps"), apart
