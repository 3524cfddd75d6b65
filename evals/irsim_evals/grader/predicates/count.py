"""``count``: how many bodies a selection holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("count")
class Count(ScenePredicate):
    """How many bodies a selection holds."""

    of: str
    """Name of the selection."""
    number: Match
    """Accepted numbers."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Count them."""
        found = len(material.bodies(scene, self.of))
        expected = f"{self.of}: {self.number.words()}"
        return Observation(matches(self.number, found, "count"), expected, f"{self.of}: {found}")
