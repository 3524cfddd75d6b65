"""Who leaves the world: nothing stops at its edge, unless walls stand there."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from irsim.common.text import clean, seconds
from irsim.results.run import Left

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["MOST_LEFT", "left_told", "left_world"]

MOST_LEFT = 10
"""Listed one by one."""
_LONGEST_NAME = 40

Floats = NDArray[np.float64]


def left_world(scenario: ResolvedScenario, track: Callable[[int], Floats], steps: int) -> list[Left]:
    """Moving objects that were in the world at the start and whose position left it, in order of time.

    Args:
        scenario: Whose objects.
        track: Positions (K, >= 2) of the object of a row, world frame, one per step up to the end of the run [m].
        steps: Executed until then.
    """
    found = []
    x, y, right, top = scenario.world.bounds
    for row, record in enumerate(scenario.objects):
        if record.static:
            continue
        place = track(row)[:, :2]
        outside = np.flatnonzero(np.any((place < (x, y)) | (place > (right, top)), axis=1))
        if not outside.size or outside[0] == 0:
            continue
        first = int(outside[0])
        px, py = (float(value) for value in place[first])
        time = (steps + 1 - len(place) + first) * scenario.world.step_time
        found.append(Left(name=record.name, time=time, x=px, y=py))
    return sorted(found, key=lambda item: item.time)


def left_told(scenario: ResolvedScenario, left: Sequence[Left]) -> str | None:
    """Who left the world, in words, and what would keep it in; None if nobody did."""
    if not left:
        return None
    first, others = left[0], len(left) - 1
    more = f" and {others} more after it" if others else ""
    open_edge = scenario.world.boundary == "none"
    advice = f" ('world.boundary: walls' would keep {'them' if others else 'it'} in)" if open_edge else ""
    return f"'{clean(first.name, _LONGEST_NAME)}' left the world at {seconds(first.time)}{more}{advice}"
