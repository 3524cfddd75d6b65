"""``near``: how far the bodies of one selection are from those of another, or from a place."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import shapely
from pydantic import model_validator

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("near")
class Near(ScenePredicate):
    """Every body of a selection is at some distance from the nearest body of another, or from a place."""

    stage = "relations"

    of: str
    """Name of the selection."""
    to: str | None = None
    """Name of the other selection."""
    place: tuple[Quantity, Quantity] | None = None
    """A place instead of a selection [m]."""
    what: Literal["position", "footprint", "goal"] = "position"
    """What of the first selection counts. Footprints are measured to footprints, edge to edge."""
    distance: Match
    """Accepted distances [m]."""
    farthest: bool = False
    """Measure to the farthest body of the other selection instead of the nearest."""

    @model_validator(mode="after")
    def _one(self) -> Near:
        if (self.to is None) == (self.place is None):
            raise ValueError("give either `to` or `place`")
        return self

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure."""
        bodies = material.bodies(scene, self.of)
        others = [] if self.to is None else material.bodies(scene, self.to)
        target = self.to if self.place is None else show(list(self.place))
        expected = f"{self.what} of {self.of} to {target}: {self.distance.words()} m"
        if not bodies or (self.place is None and not others):
            return Observation(False, expected, "no body")
        found = [(body, self._measure(body, others)) for body in bodies]
        wrong = [(body, value) for body, value in found if not matches(self.distance, value, "length")]
        return Observation(
            not wrong,
            expected,
            summary(wrong or found),
            f"{wrong[0][0].entry}.{'goal' if self.what == 'goal' else 'state'}" if wrong else None,
            marks=[Mark(points=[list(body.position)], text=body.name) for body, _ in wrong],
        )

    def _measure(self, body: Body, others: list[Body]) -> float | None:
        if self.what == "goal":
            if body.goal is None:
                return None
            at = shapely.Point(body.goal[:2])
            shapes = [other.footprint for other in others if other is not body]
        elif self.what == "footprint":
            at, shapes = body.footprint, [other.footprint for other in others if other is not body]
        else:
            at = shapely.Point(body.position)
            shapes = [shapely.Point(other.position) for other in others if other is not body]
        if self.place is not None:
            shapes = [shapely.Point(self.place)]
        if not shapes:
            return math.inf
        distances = [float(shapely.distance(at, shape)) for shape in shapes]
        return max(distances) if self.farthest else min(distances)
