"""The time limit of a scenario that gives none."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from irsim.options.units import MAX_SECONDS

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["HORIZON_FACTOR", "MIN_HORIZON", "default_time_limit"]

MIN_HORIZON = 30.0
"""Shortest default time limit of an episode [s]."""
HORIZON_FACTOR = 4.0
"""The default time limit is this many times the time of the longest straight route at top speed."""


def default_time_limit(simulation: Simulation) -> float:
    """Time limit [s] of a scenario that gives none: 4 times the longest straight route at top speed, at least 30 s.

    The latest start of a robot is added: its ``start_time`` or ``appear_time``, and the longest delay if starts are
    perturbed.
    """
    longest, starts, state = 0.0, [0.0], simulation.state
    for view in simulation.views():
        record, goals = view.record, state.goals(view.row)
        if record.role != "robot":
            continue
        start: Sequence[float] = state.initial_state(view.row)[:2].tolist()
        way = sum(math.dist(a, b) for a, b in itertools.pairwise([start, *(goal[:2] for goal in goals)]))
        if (speed := view.max_speed) > 0:
            longest = max(longest, way / speed)
        starts.append(record.moves_from + (record.spreads.delay if record.spreads else 0.0))
    return min(max(MIN_HORIZON, HORIZON_FACTOR * longest) + max(starts), MAX_SECONDS)
