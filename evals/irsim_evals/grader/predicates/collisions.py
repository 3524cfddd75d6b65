"""``collisions``: how many bodies of a selection collide."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("collisions")
class Collisions(EpisodePredicate):
    """How many bodies of a selection collide with something. An empty selection fails."""

    of: str
    """Name of the selection."""
    number: Match = Match(eq=0)
    """Accepted numbers of bodies that collide."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Count them."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} that collide: {self.number.words()}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        hits = [(body, episode.collisions(body.name)) for body in bodies]
        bad = [(body, found[0]) for body, found in hits if found]
        events = [event for event in episode.events if event.kind == "collision"]
        return Observation(
            matches(self.number, len(bad), "count"),
            expected,
            f"{len(bad)}; " + summary([(body, f"{partner} at {time:.1f} s") for body, (time, partner) in bad]),
            f"{bad[0][0].entry}.behavior" if bad else None,
            marks=[Mark(points=[[event.x, event.y]], text=f"{event.time:.1f} s") for event in events[:5]],
        )
