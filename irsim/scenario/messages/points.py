"""Places written as a flat list of numbers: where one ends and the next begins."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from irsim.diagnostics.diagnostic import Path
from irsim.options.vectors import is_vector
from irsim.scenario.model.lookup import at

__all__ = ["Meant", "places_in", "waypoints_meant"]

_OF_TURN, _ROUNDED = math.pi / 4, 0.01
"""Headings that people write are multiples of an eighth turn, rounded [rad]."""
_POSE, _TURN = 3, 2 * math.pi


class Meant(NamedTuple):
    """Places.

    Attributes:
        value: Vectors of two or three numbers; for several objects a list of them each.
        sure: There is no other way to take it.
    """

    value: list[Any]
    sure: bool = True


def places_in(numbers: Any) -> Meant | None:
    """Places of two or of three numbers each; None where there is no telling."""
    if not is_vector(numbers) or any(isinstance(number, bool) for number in numbers):
        return None
    count = len(numbers)
    if count == 4 and _is_heading(numbers[2]) and numbers[3] == 0:  # a pose, and the steering of a car
        return None
    in_pairs, in_poses = count > 0 and count % 2 == 0, count > 0 and count % _POSE == 0
    if not in_pairs and not in_poses:
        return None
    thirds = numbers[2::_POSE]
    if in_poses and (not in_pairs or all(_is_heading(number) for number in thirds)):
        return Meant(_cut(numbers, _POSE), all(abs(number) <= _TURN for number in thirds))
    return Meant(_cut(numbers, 2), not in_poses or any(abs(number) > _TURN for number in thirds))


def waypoints_meant(path: Path, data: Any) -> Meant | None:
    """A list of places, of which some hold the numbers of several, with all of them apart.

    Args:
        path: Of one of those.
        data: The whole document.
    """
    points, entry = at(data, path[:-1]), at(data, path[: path.index("waypoints")])
    if not isinstance(points, (list, tuple)) or not isinstance(entry, Mapping):
        return None
    apart = [Meant([point]) if _is_place(point) else places_in(point) for point in points]
    found = [meant for meant in apart if meant is not None]
    if len(found) < len(points):
        return None
    sure = all(meant.sure for meant in found)
    if path[-2] == "waypoints" and entry.get("number", 1) == len(points) > 1 and not any(map(_is_place, points)):
        return Meant([meant.value for meant in found], sure)
    return Meant([place for meant in found for place in meant.value], sure)


def _is_place(point: Any) -> bool:
    return is_vector(point) and len(point) in (2, _POSE)


def _is_heading(number: float) -> bool:
    return abs(number) < math.pi + _ROUNDED and abs(math.remainder(number, _OF_TURN)) < _ROUNDED


def _cut(numbers: Sequence[Any], size: int) -> list[list[Any]]:
    return [list(numbers[i : i + size]) for i in range(0, len(numbers), size)]
