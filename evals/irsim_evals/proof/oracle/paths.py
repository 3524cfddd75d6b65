"""Paths by flooding coarse cells."""

from __future__ import annotations

import math
from collections import deque

from irsim_evals.proof.oracle.shapes import Point, Thing, to_point

__all__ = ["gets_there"]

_MAX_CELLS = 6000
"""Number of cells at most."""


def gets_there(
    solids: list[Thing], bounds: tuple[float, float, float, float], start: Point, goal: Point, radius: float
) -> bool:
    """Whether a disc gets from one place to another over cells whose middle is free for it.

    Args:
        solids: What is in the way.
        bounds: x0, y0, x1, y1 of the world [m].
        start, goal: Both ends [m].
        radius: Radius of the disc [m].
    """
    if any(to_point(solid, place) < radius for solid in solids for place in (start, goal)):
        return False
    x0, y0, x1, y1 = bounds
    size = max(radius / 3, math.sqrt((x1 - x0) * (y1 - y0) / _MAX_CELLS))
    nx, ny = math.ceil((x1 - x0) / size), math.ceil((y1 - y0) / size)

    def cell(point: Point) -> tuple[int, int]:
        return min(nx - 1, max(0, int((point[0] - x0) / size))), min(ny - 1, max(0, int((point[1] - y0) / size)))

    free: dict[tuple[int, int], bool] = {}

    def is_free(at: tuple[int, int]) -> bool:
        if at not in free:
            middle = (x0 + (at[0] + 0.5) * size, y0 + (at[1] + 0.5) * size)
            free[at] = all(to_point(solid, middle) >= radius for solid in solids)
        return free[at]

    end, seen, queue = cell(goal), {cell(start)}, deque([cell(start)])
    while queue:
        i, j = queue.popleft()
        if (i, j) == end:
            return True
        for step in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= step[0] < nx and 0 <= step[1] < ny and step not in seen and (step == end or is_free(step)):
                seen.add(step)
                queue.append(step)
    return False
