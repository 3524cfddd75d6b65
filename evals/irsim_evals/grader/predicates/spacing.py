"""``spacing``: how far apart the bodies of a selection, or their goals, are from one another."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Literal

import shapely

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("spacing")
class Spacing(ScenePredicate):
    """The smallest distance between any two bodies of a selection, of which there must be two."""

    stage = "relations"

    of: str
    """Name of the selection."""
    what: Literal["position", "footprint", "goal"] = "position"
    """What is measured: between positions, between the edges of footprints, or between last goals."""
    distance: Match
    """Accepted values of the smallest distance [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure all pairs."""
        bodies = [body for body in material.bodies(scene, self.of) if self.what != "goal" or body.goal]
        expected = f"{self.what} of {self.of} apart: {self.distance.words()} m"
        pairs = [(self._apart(a, b), a, b) for a, b in itertools.combinations(bodies, 2)]
        if not pairs:
            return Observation(False, expected, f"{len(bodies)} bodies")
        least, a, b = min(pairs, key=lambda pair: pair[0])
        passed = matches(self.distance, least, "length")
        marks = [] if passed else [Mark(points=[list(a.position), list(b.position)], text=f"{least:.2f} m")]
        return Observation(passed, expected, f"{a.name} and {b.name}: {show(least)} m", f"{b.entry}.state", marks=marks)

    def _apart(self, a: Body, b: Body) -> float:
        if self.what == "footprint":
            return float(shapely.distance(a.footprint, b.footprint))
        if self.what == "goal" and a.goal is not None and b.goal is not None:
            return math.dist(a.goal[:2], b.goal[:2])
        return math.dist(a.position, b.position)
