"""Objects that leave the world, whose edge stops nothing unless ``world.boundary`` is ``walls``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.text import quoted, seconds
from irsim.results.run import Left

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["MAX_LISTED_EXITS", "exits_message", "find_exits"]

MAX_LISTED_EXITS = 10
"""Number of exits that a result lists one by one."""


def find_exits(scenario: ResolvedScenario, track: Callable[[int], Floats], steps: int) -> list[Left]:
    """Find moving objects that start in the world and leave it, in order of time.

    Args:
        scenario: The scenario that was simulated.
        track: Row of an object -> its (K, >= 2) positions [m], world frame, one per step up to the end of the run.
        steps: Number of steps executed by the end of the run.
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


def exits_message(scenario: ResolvedScenario, left: Sequence[Left]) -> str | None:
    """Which object left the world first, and what would keep it in; None if none did."""
    if not left:
        return None
    first, others = left[0], len(left) - 1
    more = f" and {others} more after it" if others else ""
    open_edge = scenario.world.boundary == "none"
    advice = f" ('world.boundary: walls' would keep {'them' if others else 'it'} in)" if open_edge else ""
    return f"{quoted(first.name)} left the world at {seconds(first.time)}{more}{advice}"
