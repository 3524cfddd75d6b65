"""Splits poses that were written as one flat list of numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.model.lookup import at

__all__ = ["Poses", "split_poses", "split_waypoints"]

_HEADING_STEP = math.pi / 4
"""Written headings are usually multiples of an eighth of a turn [rad]."""
_HEADING_ROUNDING = 0.01
"""Deviation of a written heading from such a multiple [rad]."""
_POSE_SIZE = 3
"""Numbers of a pose: x, y and heading."""
_FULL_TURN = 2 * math.pi


class Poses(NamedTuple):
    """Poses found in a flat list of numbers.

    Attributes:
        value: Vectors of two or three numbers; for several objects one list of them per object.
        sure: Whether there is no other way to split the list.
    """

    value: list[Any]
    sure: bool = True


def split_poses(numbers: Any) -> Poses | None:
    """The poses of two or three numbers each in a flat list; None if it is not clear where each ends."""
    if not is_vector(numbers) or any(isinstance(number, bool) for number in numbers):
        return None
    count = len(numbers)
    if count == 4 and _is_heading(numbers[2]) and numbers[3] == 0:  # one pose with the steering angle of a car
        return None
    in_pairs, in_poses = count > 0 and count % 2 == 0, count > 0 and count % _POSE_SIZE == 0
    if not in_pairs and not in_poses:
        return None
    thirds = numbers[2::_POSE_SIZE]
    if in_poses and (not in_pairs or all(_is_heading(number) for number in thirds)):
        return Poses(_cut(numbers, _POSE_SIZE), all(abs(number) <= _FULL_TURN for number in thirds))
    return Poses(_cut(numbers, 2), not in_poses or any(abs(number) > _FULL_TURN for number in thirds))


def split_waypoints(path: Path, data: Any) -> Poses | None:
    """The waypoints of a list in which some elements hold the numbers of several poses; None if it is not clear.

    Args:
        path: Path of one of those elements.
        data: The whole document.
    """
    points, entry = at(data, path[:-1]), at(data, path[: path.index("waypoints")])
    if not isinstance(points, (list, tuple)) or not isinstance(entry, Mapping):
        return None
    split = [Poses([point]) if _is_pose(point) else split_poses(point) for point in points]
    found = [poses for poses in split if poses is not None]
    if len(found) < len(points):
        return None
    sure = all(poses.sure for poses in found)
    if path[-2] == "waypoints" and entry.get("number", 1) == len(points) > 1 and not any(map(_is_pose, points)):
        return Poses([poses.value for poses in found], sure)
    return Poses([pose for poses in found for pose in poses.value], sure)


def _is_pose(point: Any) -> bool:
    return is_vector(point) and len(point) in (2, _POSE_SIZE)


def _is_heading(number: float) -> bool:
    remainder = math.remainder(number, _HEADING_STEP)
    return abs(number) < math.pi + _HEADING_ROUNDING and abs(remainder) < _HEADING_ROUNDING


def _cut(numbers: Sequence[Any], size: int) -> list[list[Any]]:
    return [list(numbers[i : i + size]) for i in range(0, len(numbers), size)]
