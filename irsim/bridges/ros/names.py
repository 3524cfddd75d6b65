"""Names and times as ROS writes them."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["nanoseconds", "ros_names"]

_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")


def nanoseconds(seconds: float) -> int:
    """A time [s] in whole nanoseconds."""
    return round(seconds * 1e9)


def ros_names(names: Iterable[str]) -> list[str]:
    """Names of objects as parts of topics: letters, digits and single underscores, each only once.

    ``robot 1`` becomes ``robot_1``, and a name that begins with a digit gets ``object_`` in front.
    """
    made: list[str] = []
    for name in names:
        plain = _NOT_IN_NAMES.sub("_", name).strip("_")
        plain = plain if plain and not plain[0].isdigit() else f"object_{plain}".rstrip("_")
        number, unique = 1, plain
        while unique in made:
            number += 1
            unique = f"{plain}_{number}"
        made.append(unique)
    return made
