"""Names of prims: letters, digits and underscores, as every version of OpenUSD accepts them."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["prim_names"]

_LONGEST = 100


def prim_names(names: Iterable[str]) -> list[str]:
    """A valid name for each name, all different: ``robot 1`` becomes ``robot_1``, a second one ``robot_1_2``."""
    taken: set[str] = set()
    found = []
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)[:_LONGEST] or "object"
        plain = f"_{plain}" if plain[0].isdigit() else plain
        chosen, number = plain, 2
        while chosen.lower() in taken:
            chosen, number = f"{plain}_{number}", number + 1
        taken.add(chosen.lower())
        found.append(chosen)
    return found
