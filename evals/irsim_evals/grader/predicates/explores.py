"""``explores``: the explored share of the fog map grows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("explores")
class Explores(EpisodePredicate):
    """The explored share of the fog map at some time, compared with that after the first step."""

    at: Quantity
    """Time [s]."""
    growth: Match
    """Accepted factors."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Compare the shares."""
        expected = f"explored share after {self.at:g} s: {self.growth.words()} times that of the first step"
        if not episode.explored:
            return Observation(False, expected, "there is no fog map", "world.fog_map")
        first = episode.explored[0][1]
        later = max((item for item in episode.explored if item[0] <= self.at + 1e-6), key=lambda item: item[0])
        factor = later[1] / first if first > 0 else 0.0
        observed = f"{first:.1%} after the first step, {later[1]:.1%} after {later[0]:.1f} s: {show(factor)} times"
        return Observation(matches(self.growth, factor, "share"), expected, observed, "world.fog_map")
