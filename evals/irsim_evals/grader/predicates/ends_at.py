"""``ends_at``: on which part of its way a body stands at the end of an episode."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("ends_at")
class EndsAt(EpisodePredicate):
    """Every body of a selection ends at a share of the straight way from its start to its last goal: 0 is the start, 1
    the goal. An empty selection fails."""

    of: str
    """Name of the selection."""
    share: Match
    """Accepted shares."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Look at the last positions."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} ends at {self.share.words()} of its way"
        missing = [body for body in bodies if body.goal is None]
        if not bodies or missing:
            return Observation(False, expected, f"{missing[0].name}: no goal" if missing else f"{self.of}: no body")
        found = []
        for body in bodies:
            (x, y), goal = body.pose[:2], body.goal or [0.0, 0.0]
            way = math.dist((x, y), goal[:2]) or math.inf
            end_x, end_y = episode.positions(body.index)[-1].tolist()
            along = ((end_x - x) * (goal[0] - x) + (end_y - y) * (goal[1] - y)) / way
            found.append((body, along / way))
        wrong = [(body, value) for body, value in found if not matches(self.share, value, "share")]
        return Observation(
            not wrong,
            expected,
            summary([(body, show(value)) for body, value in wrong or found]),
            f"{wrong[0][0].entry}.behavior" if wrong else None,
            marks=[Mark(points=[episode.positions(body.index)[-1].tolist()], text=body.name) for body, _ in wrong],
        )
