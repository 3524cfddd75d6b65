"""``corridor``: the free width around a body's way from start to goal, and how long the walls beside it are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register
from irsim_evals.grader.rays import along, free_length

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

_FAR = 1e3
"""Distance [m] at which a wall is no longer looked for."""
_STEP = 0.05
"""Distance [m] between the sections that measure how long the walls are."""


@register("corridor")
class Corridor(ScenePredicate):
    """Each body of a selection goes along a corridor: solid on both sides of the line from its start to its goal."""

    stage = "relations"

    of: str
    """Name of the selection."""
    width: Match
    """Accepted free widths [m], measured across the line at each section."""
    sections: int = 12
    """Number of sections, evenly spaced from start to goal."""
    direction: Quantity | None = None
    """Direction of the corridor [rad], if not that from start to goal."""
    length: Match | None = None
    """Accepted lengths of the walls on both sides [m], as far as the width holds."""
    start_within: Quantity | None = None
    """Greatest share of the corridor's length that lies before the start and behind the goal."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure the sections."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        expected = f"a corridor {self.width.words()} m wide" + (
            f", {self.length.words()} m long" if self.length is not None else ""
        )
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        for body in bodies:
            start, goal = (body.pose[0], body.pose[1]), _end(body)
            way = math.dist(start, goal)
            heading = math.atan2(goal[1] - start[1], goal[0] - start[0]) if self.direction is None else self.direction
            for k in range(self.sections):
                at = along(start, heading, way * k / max(1, self.sections - 1))
                width = self._width(scene, at, heading)
                if not matches(self.width, width, "length"):
                    seen = f"{show(width)} m" if width < _FAR else "no wall on one side"
                    marks = [Mark(points=[list(at)], text=seen)]
                    return Observation(False, expected, f"at ({at[0]:.2f}, {at[1]:.2f}): {seen}", marks=marks)
            if self.length is None:
                continue
            back, front = (self._reach(scene, p, h) for p, h in ((start, heading + math.pi), (goal, heading)))
            total = back + way + front
            if not matches(self.length, total, "length"):
                return Observation(False, expected, f"walls on both sides for {show(total)} m")
            if self.start_within is not None and max(back, front) > self.start_within * total + 1e-6:
                return Observation(False, expected, f"{show(max(back, front))} m of it lie before or behind the way")
        return Observation(True, expected, f"{self.sections} sections")

    def _width(self, scene: Scene, at: tuple[float, float], heading: float) -> float:
        sides = [free_length(scene.solid, at, heading + turn, _FAR) for turn in (math.pi / 2, -math.pi / 2)]
        return _FAR if max(sides) >= _FAR else sum(sides)

    def _reach(self, scene: Scene, start: tuple[float, float], heading: float) -> float:
        """How far the walls go on from a place [m]."""
        x0, y0, x1, y1 = scene.bounds
        most, done = math.hypot(x1 - x0, y1 - y0), 0.0
        while done < most and matches(self.width, self._width(scene, along(start, heading, done), heading), "length"):
            done += _STEP
        return max(0.0, done - _STEP)


def _end(body: Body) -> tuple[float, float]:
    goal = body.goal or [0.0, 0.0]
    return goal[0], goal[1]
