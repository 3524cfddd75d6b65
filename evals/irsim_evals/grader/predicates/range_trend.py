"""``range_trend``: how many bodies come nearer to another one, and how many go away from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("range_trend")
class RangeTrend(EpisodePredicate):
    """How many bodies of a selection come nearer to a body, and how many go away from it."""

    of: str
    """Name of the selection."""
    to: str
    """Selection of the one body."""
    within: Quantity
    """Time over which the distance is compared [s]."""
    nearer: Match
    """Accepted numbers of bodies that come nearer."""
    farther: Match
    """Accepted numbers of bodies that go away."""
    by: Quantity = 0.1
    """Least change of the distance that counts [m]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Compare the distances."""
        bodies, one = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.to)
        expected = f"{self.of} nearer to {self.to}: {self.nearer.words()}, farther: {self.farther.words()}"
        if not bodies or len(one) != 1:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.to}: {len(one)}")
        row = min(len(episode.trace) - 1, round(self.within / episode.trace.step_time))
        middle = episode.positions(one[0].index)
        changes = []
        for body in bodies:
            apart = np.hypot(*(episode.positions(body.index) - middle).T)
            changes.append((body, float(apart[row] - apart[0])))
        nearer, farther = (sum(sign * change >= self.by for _, change in changes) for sign in (-1, 1))
        passed = matches(self.nearer, nearer, "count") and matches(self.farther, farther, "count")
        text = summary([(body, f"{show(change)} m") for body, change in changes])
        return Observation(passed, expected, f"nearer {nearer}, farther {farther} ({text})", f"{bodies[0].entry}.goal")
