"""``crowding``: how much of the world is taken by bodies, and how many there are for its area."""

from __future__ import annotations

from typing import TYPE_CHECKING

import shapely

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("crowding")
class Crowding(ScenePredicate):
    """The bodies of a selection cover a share of the world, or there are so many for each 10 m²; one is enough."""

    stage = "relations"

    of: str
    """Name of the selection."""
    cover: Match | None = None
    """Accepted shares of the area."""
    per_10_m2: Match | None = None
    """Accepted numbers for each 10 m²."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Add up the areas."""
        x0, y0, x1, y1 = scene.bounds
        area = (x1 - x0) * (y1 - y0)
        bodies = material.bodies(scene, self.of)
        cover = shapely.union_all([body.footprint for body in bodies]).area / area
        density = 10 * len(bodies) / area
        passed = (self.cover is not None and matches(self.cover, cover, "share")) or (
            self.per_10_m2 is not None and matches(self.per_10_m2, density, "share")
        )
        words = [
            f"{what} {match.words()}"
            for what, match in (("share of the area", self.cover), ("number for each 10 m²", self.per_10_m2))
            if match is not None
        ]
        return Observation(
            bool(bodies) and passed,
            f"{self.of}: " + " or ".join(words),
            f"share {show(cover)}, {show(density)} for each 10 m²",
        )
