"""``pocket``: a dead end between a body and its goal, such as a U that opens toward it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register
from irsim_evals.grader.rays import Point, along, free_length

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

_FAR = 1e3
"""Distance [m] at which a wall is no longer looked for."""
_STEP = 0.02
"""Distance [m] between the sections that measure the depth."""
_BEFORE = 0.1
"""Distance [m] of the first section from the back of the pocket."""
_RAYS = 91
"""Directions in which gaps between the walls are looked for."""


@register("pocket")
class Pocket(ScenePredicate):
    """The straight line from start to goal leads into a pocket and hits its back."""

    stage = "relations"

    of: str
    """Name of the selection."""
    width: Match
    """Accepted free widths inside [m]."""
    depth: Match
    """Accepted depths from the opening to the back [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Go in and measure."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        expected = f"a pocket {self.width.words()} m wide and {self.depth.words()} m deep on the way"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        for body in bodies:
            start, goal = body.pose[:2], (body.goal or [0.0, 0.0])[:2]
            way, heading = math.dist(start, goal), math.atan2(goal[1] - start[1], goal[0] - start[0])
            back = free_length(scene.solid, start, heading, way)
            if back >= way:
                return Observation(False, expected, f"nothing solid between {body.name} and its goal")
            widths, depth = self._go_out(scene, start, heading, back)
            if not widths:
                marks = [Mark(points=[list(along(start, heading, back))], text="no pocket")]
                return Observation(False, expected, "no walls on both sides before what is hit", marks=marks)
            width = sorted(widths)[len(widths) // 2]
            if not (matches(self.width, width, "length") and matches(self.depth, depth, "length")):
                return Observation(False, expected, f"{show(width)} m wide, {show(depth)} m deep")
            gap = _gap(scene, along(start, heading, back - depth / 2), heading, math.hypot(width, depth))
            if gap is not None:
                return Observation(
                    False, expected, "its walls leave a gap", marks=[Mark(points=[list(gap)], text="gap")]
                )
        return Observation(True, expected, "so it is")

    def _go_out(self, scene: Scene, start: Point, heading: float, back: float) -> tuple[list[float], float]:
        """Free widths from the back to the opening, and the depth [m]."""
        widths: list[float] = []
        depth = _BEFORE
        while depth < back:
            at = along(start, heading, back - depth)
            sides = [free_length(scene.solid, at, heading + turn, _FAR) for turn in (math.pi / 2, -math.pi / 2)]
            if max(sides) >= _FAR or (widths and sum(sides) > 1.5 * widths[0]):
                break
            widths.append(sum(sides))
            depth += _STEP
        return widths, depth - _STEP / 2


def _gap(scene: Scene, inside: Point, heading: float, far: float) -> Point | None:
    """A place where one sees out of the pocket from its inside other than through its opening; None without one."""
    for k in range(_RAYS):
        direction = heading + math.pi * (k / (_RAYS - 1) - 0.5)
        if free_length(scene.solid, inside, direction, far) >= far:
            return along(inside, direction, far)
    return None
