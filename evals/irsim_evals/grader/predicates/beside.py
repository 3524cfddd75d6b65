"""``beside``: on which side of another body's way the bodies of a selection start or end."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from irsim_evals.grader.matching import Quantity
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("beside")
class Beside(ScenePredicate):
    """Every body of a selection starts, or has its goal, on one side of another body's way."""

    stage = "relations"

    of: str
    """Name of the selection."""
    way_of: str
    """Selection of one body, whose way leads from its start to its goal."""
    what: Literal["start", "goal"] = "start"
    """What lies there."""
    side: Literal["left", "right", "ahead", "behind"]
    """Seen from the start of the way toward its goal."""
    by: Quantity = 0.0
    """Least distance from the line [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure the distances."""
        bodies, ways = material.bodies(scene, self.of), material.bodies(scene, self.way_of)
        expected = f"{self.what} of {self.of} {self.side} of the way of {self.way_of}"
        if not bodies or len(ways) != 1 or ways[0].goal is None:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.way_of}: {len(ways)}")
        (x, y, _), goal = ways[0].pose, ways[0].goal
        length = math.dist((x, y), goal[:2]) or 1.0
        dx, dy = (goal[0] - x) / length, (goal[1] - y) / length
        found = []
        for body in bodies:
            point = body.position if self.what == "start" else body.goal
            if point is None:
                found.append((body, -math.inf))
                continue
            px, py = point[0] - x, point[1] - y
            ahead, left = px * dx + py * dy, dx * py - dy * px
            found.append((body, {"left": left, "right": -left, "ahead": ahead, "behind": -ahead}[self.side]))
        wrong = [(body, value) for body, value in found if value < self.by - 1e-9 or value <= 0]
        return Observation(
            not wrong,
            expected,
            summary(wrong or found),
            f"{wrong[0][0].entry}.{'state' if self.what == 'start' else 'goal'}" if wrong else None,
        )
