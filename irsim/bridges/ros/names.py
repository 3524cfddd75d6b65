"""Names and times as ROS writes them."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["nanoseconds", "ros_names"]

_FITS = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9]+")


def nanoseconds(seconds: float) -> int:
    """A time [s] in whole nanoseconds."""
    return round(seconds * 1e9)


def ros_names(names: Iterable[str]) -> list[str]:
    """Names of objects as parts of topics: letters, digits and single underscores, each only once.

    ``robot 1`` becomes ``robot_1``, and a name that begins with a digit gets ``object_`` in front. A name that can be
    part of a topic stays as it is, whatever the others are.
    """
    given = list(names)
    fitting = {name for name in given if _FITS.fullmatch(name)}
    made: list[str] = []
    for name in given:
        if name in fitting:
            made.append(name)
            continue
        plain = _NOT_IN_NAMES.sub("_", name).strip("_")
        plain = plain if plain and not plain[0].isdigit() else f"object_{plain}".rstrip("_")
        number, unique = 1, plain
        while unique in made or unique in fitting:
            number += 1
            unique = f"{plain}_{number}"
        made.append(unique)
    return made
