"""``distinct``: how many different values a property has among bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim_evals.grader.hues import discernible
from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register
from irsim_evals.grader.properties import value_of, yaml_path

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("distinct")
class Distinct(ScenePredicate):
    """How many different values a property has among the bodies of a selection; colors must look different."""

    of: str
    """Name of the selection."""
    property: str
    """Name of the property."""
    number: Match
    """Accepted numbers of different values."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Collect the values."""
        bodies = material.bodies(scene, self.of)
        found = [value_of(scene, body, self.property) for body in bodies]
        values = set(map(show, discernible(found) if self.property == "color" else found))
        passed = bool(bodies) and matches(self.number, len(values), "count")
        shown = ", ".join(sorted(values)[:6])
        return Observation(
            passed,
            f"{self.of}: {self.number.words()} different values of {self.property}",
            f"{len(values)}: {shown}",
            yaml_path(bodies[0], self.property) if bodies else None,
        )
