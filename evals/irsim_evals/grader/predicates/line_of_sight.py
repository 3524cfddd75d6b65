"""``line_of_sight``: whether something solid stands between the start of a body and its goal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import shapely

from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("line_of_sight")
class LineOfSight(ScenePredicate):
    """Whether the straight line from each start to the goal is free. An empty selection fails."""

    stage = "relations"

    of: str
    """Name of the selection."""
    clear: bool
    """Whether the line is free of everything solid, or not."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Draw the lines."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        expected = f"from each of {self.of} to its goal the view is {'clear' if self.clear else 'blocked'}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        lines = {body.name: shapely.LineString([body.pose[:2], (body.goal or [])[:2]]) for body in bodies}
        clear = [(body, not shapely.intersects(scene.solid, lines[body.name])) for body in bodies]
        wrong = [(body, value) for body, value in clear if value != self.clear]
        return Observation(
            not wrong,
            expected,
            "clear for " + summary(wrong or clear),
            f"{wrong[0][0].entry}.goal" if wrong else None,
            marks=[Mark(points=[list(p) for p in lines[body.name].coords], text=body.name) for body, _ in wrong],
        )
