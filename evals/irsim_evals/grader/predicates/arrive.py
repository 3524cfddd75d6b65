"""``arrive``: bodies reach their last goal, or do not, or end near it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("arrive")
class Arrive(EpisodePredicate):
    """A share of the bodies of a selection arrives. An empty selection fails."""

    of: str
    """Name of the selection."""
    share: Match = Match(eq=1.0)
    """Accepted shares of bodies that arrive; 0 for a body that must not."""
    within: Quantity | None = None
    """Latest time [s]; default: the end of the episode."""
    or_near: Quantity | None = None
    """Ending at most this far from the goal [m] counts as well."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Look at the arrivals."""
        bodies = material.bodies(episode.scene, self.of)
        end = episode.duration if self.within is None else self.within
        expected = f"share of {self.of} that arrive within {show(end)} s: {self.share.words()}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        found = []
        for body in bodies:
            time = episode.arrival(body.name)
            there = time is not None and time <= end + 1e-9
            if not there and self.or_near is not None and body.goal is not None:
                there = math.dist(episode.positions(body.index)[-1], body.goal[:2]) <= self.or_near
            found.append((body, there, "not" if time is None else f"after {time:.1f} s"))
        share = sum(there for _, there, _ in found) / len(found)
        wanted = self.share.eq != 0.0
        odd = [(body, text) for body, there, text in found if there != wanted]
        return Observation(
            matches(self.share, share, "share"),
            expected,
            f"{share:.0%}; " + summary(odd or [(body, text) for body, _, text in found]),
            f"{(odd[0][0] if odd else bodies[0]).entry}.goal",
        )
