"""Tracks: what moving objects leave behind, as data that only grows, so that a picture need only draw what is new."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from irsim.common.arrays import Floats
from irsim.graphics.scene.scene import Line, Mark, Stroke
from irsim.graphics.scene.style import Color

__all__ = ["GrowingLine", "GrowingTrail", "Track"]

_FIRST_CAPACITY = 64


@dataclass(slots=True, eq=False)
class GrowingLine:
    """The path of an object, one line with a solid stroke of one colour.

    Another path, such as the next episode's, is another Python object.
    """

    object: int
    stroke: Stroke
    alpha: float
    zorder: float
    count: int = 0
    _points: Floats = field(default_factory=lambda: np.empty((_FIRST_CAPACITY, 2)))

    @property
    def part(self) -> str:
        """The part of the object that the line shows."""
        return "trajectory"

    @property
    def color(self) -> Color | None:
        """Colour of the line."""
        return self.stroke.color

    @property
    def points(self) -> Floats:
        """(count, 2) points of the line, which must not be changed."""
        return self._points[: self.count]

    def extend(self, points: Floats) -> None:
        """Append points (K, 2)."""
        count = self.count + len(points)
        if count > len(self._points):
            larger = np.empty((2 * count, 2))
            larger[: self.count] = self.points
            self._points = larger
        self._points[self.count : count] = points
        self.count = count

    def marks(self) -> list[Mark]:
        """Return the line as one mark; a single point makes no line."""
        if self.count < 2:
            return []
        line = Line(self.points.copy())
        return [Mark(self.object, self.part, line, None, self.stroke, self.alpha, self.zorder)]


@dataclass(slots=True, eq=False)
class GrowingTrail:
    """Snapshots of an object; ``every`` is the number of steps from one to the next."""

    object: int
    zorder: float
    every: int
    snapshots: list[Mark] = field(default_factory=list)

    @property
    def part(self) -> str:
        """The part of the object that the snapshots show."""
        return "trail"

    def marks(self) -> list[Mark]:
        """Return all snapshots."""
        return self.snapshots


Track = GrowingLine | GrowingTrail
