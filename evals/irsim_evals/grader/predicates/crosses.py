"""``crosses``: bodies cross the way of another one ahead of it, at different times."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, Quantity, matches
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("crosses")
class Crosses(EpisodePredicate):
    """Bodies of a selection cross the line of another body's way from one side to the other."""

    of: str
    """Name of the selection."""
    way_of: str
    """Selection of one body, whose way leads from its start to its goal."""
    number: Match
    """Accepted numbers of bodies that cross."""
    ahead: bool = True
    """Only crossings ahead of the body count."""
    direction: str | None = None
    """``right_to_left`` or ``left_to_right``, seen by the body; only those count."""
    spread: Quantity = 0.0
    """Least time between the first and the last crossing [s]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Look for changes of side."""
        bodies, ways = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.way_of)
        expected = f"{self.of} that cross ahead of {self.way_of}: {self.number.words()}"
        if self.spread:
            expected += f", over at least {self.spread:g} s"
        if not bodies or len(ways) != 1 or ways[0].goal is None:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.way_of}: {len(ways)}")
        start, goal = np.array(ways[0].pose[:2]), np.array(ways[0].goal[:2])
        unit = (goal - start) / (math.dist(start, goal) or 1.0)
        own = (episode.positions(ways[0].index) - start) @ unit
        times = []
        for body in bodies:
            offset = episode.positions(body.index) - start
            left, far = unit[0] * offset[:, 1] - unit[1] * offset[:, 0], offset @ unit
            for row in np.flatnonzero((left[1:] > 0) != (left[:-1] > 0)).tolist():
                way = "right_to_left" if left[row + 1] > 0 else "left_to_right"
                if (not self.ahead or far[row] > own[row]) and self.direction in (None, way):
                    times.append(float(episode.trace.time[row]))
                    break
        spread = max(times) - min(times) if times else 0.0
        passed = matches(self.number, len(times), "count") and spread >= self.spread - 1e-9
        seen = ", ".join(f"{time:.1f} s" for time in sorted(times))
        return Observation(passed, expected, f"{len(times)}: {seen}", f"{bodies[0].entry}.state")
