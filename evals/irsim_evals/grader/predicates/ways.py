"""``ways``: how the straight ways of bodies, from start to goal, lie to each other."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import shapely

from irsim.common.angles import wrap
from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("ways")
class Ways(ScenePredicate):
    """The straight lines from start to last goal of any two bodies of a selection, of which there must be two."""

    stage = "relations"

    of: str
    """Name of the selection."""
    angle: Match | None = None
    """Accepted angles between the directions of two ways [rad]: 0 for the same direction, π for opposite ones."""
    distance: Match | None = None
    """Accepted values of the smallest distance between two ways [m]; 0 where they cross."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Compare all pairs."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        words = []
        if self.angle is not None:
            words.append(f"angle {self.angle.words()} rad")
        if self.distance is not None:
            words.append(f"{self.distance.words()} m apart")
        expected = f"ways of {self.of}: {', '.join(words)}"
        if len(bodies) < 2:
            return Observation(False, expected, f"{len(bodies)} bodies with a goal")
        seen = ""
        for a, b in itertools.combinations(bodies, 2):
            angle, distance = abs(wrap(_direction(a) - _direction(b))), float(shapely.distance(_line(a), _line(b)))
            seen = f"{a.name} and {b.name}: {math.degrees(angle):.0f}°, {show(distance)} m apart"
            off = self.angle is not None and not matches(self.angle, angle, "angle")
            far = self.distance is not None and not matches(self.distance, distance, "length")
            if off or far:
                marks = [Mark(points=[list(p) for p in _line(body).coords], text=body.name) for body in (a, b)]
                return Observation(False, expected, seen, f"{b.entry}.goal", marks=marks)
        return Observation(True, expected, seen)


def _direction(body: Body) -> float:
    goal = body.goal or [*body.pose]
    return math.atan2(goal[1] - body.pose[1], goal[0] - body.pose[0])


def _line(body: Body) -> shapely.LineString:
    return shapely.LineString([body.pose[:2], (body.goal or [*body.pose])[:2]])
