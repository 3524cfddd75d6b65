"""Groups: marks of one part and layer whose shapes lie in common arrays, so that they are made and painted at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from irsim.common.arrays import Floats
from irsim.graphics.scene.bodies import Pose
from irsim.graphics.scene.scene import NO_CIRCLE, Group, Look

__all__ = ["Outlines", "boxes_of", "circles", "kept", "placed_areas", "ranges_between"]


def ranges_between(ends: Sequence[int] | NDArray[np.int64]) -> NDArray[np.int64]:
    """(N, 2) first and end of the points of each of N shapes that follow one another, from 0 and their ends (N + 1)."""
    borders = np.asarray(ends, dtype=np.int64)
    ranges = np.empty((len(borders) - 1, 2), dtype=np.int64)
    ranges[:, 0], ranges[:, 1] = borders[:-1], borders[1:]
    return ranges


def boxes_of(groups: Sequence[Group]) -> Floats:
    """(N, 4) left, bottom, right and top of the shapes of groups, whose points follow one another [m]."""
    if not groups:
        return np.empty((0, 4))
    points = np.concatenate([group.points for group in groups])
    sizes = np.concatenate([group.ranges[:, 1] - group.ranges[:, 0] for group in groups])
    reach = np.maximum(np.concatenate([group.radii for group in groups]), 0.0)[:, None]
    starts = np.cumsum(sizes) - sizes
    low, high = np.minimum.reduceat(points, starts), np.maximum.reduceat(points, starts)
    return np.concatenate([low - reach, high + reach], axis=1)


def kept(group: Group, before: Group | None) -> Group:
    """The group of the last frame if a new one shows the same, so that the figure need not draw it again."""
    same = (
        before is not None
        and group.looks == before.looks
        and group.objects == before.objects
        and group.points.tobytes() == before.points.tobytes()
        and group.ranges.tobytes() == before.ranges.tobytes()
        and group.radii.tobytes() == before.radii.tobytes()
    )
    return before if same and before is not None else group


def placed_areas(
    part: str,
    zorder: float,
    numbers: Sequence[int],
    rings: Sequence[Floats] | Floats,
    poses: Sequence[Pose] | Floats,
    looks: list[Look],
) -> list[Group]:
    """One group of areas with equally many corners, each turned and moved to a pose; none without any.

    Args:
        part: The part that they show.
        zorder: Their layer.
        numbers: Objects (N).
        rings: N rings (M, 2) in the body frame [m].
        poses: x, y [m] and heading [rad] of each.
        looks: The look of each.
    """
    if not len(rings):
        return []
    corners = np.asarray(rings)
    x, y, heading = np.asarray(poses).T[:, :, None]
    across, up, c, s = corners[:, :, 0], corners[:, :, 1], np.cos(heading), np.sin(heading)
    placed = np.empty_like(corners)
    placed[:, :, 0] = c * across - s * up + x
    placed[:, :, 1] = s * across + c * up + y
    ranges = ranges_between(np.arange(len(rings) + 1) * corners.shape[1])
    return [Group(part, zorder, True, numbers, placed.reshape(-1, 2), ranges, np.full(len(rings), NO_CIRCLE), looks)]


def circles(
    part: str, zorder: float, numbers: Sequence[int], places: Floats, radii: Floats, looks: list[Look]
) -> list[Group]:
    """One group of circles; none without any.

    Args:
        part: The part that they show.
        zorder: Their layer.
        numbers: Objects (N).
        places: (N, 2) centres [m].
        radii: (N,) radii [m].
        looks: The look of each.
    """
    if not looks:
        return []
    ranges = ranges_between(np.arange(len(looks) + 1))
    return [Group(part, zorder, True, numbers, places, ranges, radii, looks)]


class Outlines:
    """Collects circles and areas, of which groups with different looks are made."""

    def __init__(self) -> None:
        self._objects: list[int] = []
        self._points: list[tuple[float, float]] = []
        self._radii: list[float] = []
        self._ends = [0]

    def add_circle(self, number: int, x: float, y: float, radius: float) -> None:
        """Add a circle of an object."""
        self._objects.append(number)
        self._points.append((x, y))
        self._radii.append(radius)
        self._ends.append(len(self._points))

    def add_area(self, number: int, ring: Floats) -> None:
        """Add an area of an object inside a ring (M, 2)."""
        self._objects.append(number)
        self._points += ring.tolist()
        self._radii.append(NO_CIRCLE)
        self._ends.append(len(self._points))

    def groups(self, layers: Sequence[tuple[str, float, list[Look]]]) -> list[Group]:
        """One group of everything for each part, zorder and looks; none without anything."""
        if not self._objects:
            return []
        ranges = ranges_between(self._ends)
        points, radii = np.array(self._points, dtype=np.float64), np.array(self._radii)
        return [Group(part, z, True, self._objects, points, ranges, radii, looks) for part, z, looks in layers]
