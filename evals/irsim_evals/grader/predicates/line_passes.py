"""``line_passes``: how near the straight way of a body comes to the middle of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import shapely

from irsim_evals.grader.matching import Match, matches
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("line_passes")
class LinePasses(ScenePredicate):
    """The straight line from start to goal of every body of a selection comes near the middle of another selection."""

    stage = "relations"

    of: str
    """Name of the selection."""
    by: str
    """Name of the other selection: its middle is the mean of its positions."""
    distance: Match
    """Accepted distances of the line from that middle [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        places = [other.position for other in material.bodies(scene, self.by)]
        expected = f"the way of {self.of} passes the middle of {self.by} at {self.distance.words()} m"
        if not bodies or not places:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.by}: {len(places)}")
        middle = shapely.Point(sum(x for x, _ in places) / len(places), sum(y for _, y in places) / len(places))
        found = [
            (body, float(shapely.LineString([body.pose[:2], (body.goal or [])[:2]]).distance(middle)))
            for body in bodies
        ]
        wrong = [(body, value) for body, value in found if not matches(self.distance, value, "length")]
        return Observation(not wrong, expected, summary(wrong or found), f"{wrong[0][0].entry}.goal" if wrong else None)
