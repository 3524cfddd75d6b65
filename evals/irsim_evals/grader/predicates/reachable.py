"""``reachable``: whether bodies can get to their goals round everything solid, and whether only through some gap."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Literal

import shapely

from irsim_evals.grader.matching import Quantity
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("reachable")
class Reachable(ScenePredicate):
    """Every body of a selection can get from its start to each of its goals, on a grid of inflated obstacles."""

    stage = "relations"

    of: str
    """Name of the selection."""
    size: Literal["inner", "outer"] = "inner"
    """Disc that stands for the body: the largest one inside of it, or the smallest one round it."""
    possible: bool = True
    """Whether there must be a path, or must not."""
    to: tuple[Quantity, Quantity] | None = None
    """A place instead of the goals [m]."""
    plug: tuple[Quantity, Quantity, Quantity] | None = None
    """x, y, radius of a disc that closes a gap first [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Search for paths."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goals or self.to is not None]
        closed = "" if self.plug is None else f" with the gap at ({self.plug[0]:g}, {self.plug[1]:g}) closed"
        target = "its goal" if self.to is None else f"({self.to[0]:g}, {self.to[1]:g})"
        expected = f"each of {self.of} {'can' if self.possible else 'cannot'} get to {target}{closed}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        plugs = () if self.plug is None else (self.plug,)
        found = [(body, self._gets_there(scene, body, plugs)) for body in bodies]
        wrong = [(body, value) for body, value in found if value != self.possible]
        return Observation(
            not wrong,
            expected,
            "a path for " + summary(wrong or found),
            f"{wrong[0][0].entry}.goal" if wrong else None,
            marks=[Mark(points=[list(place)], text=body.name) for body, _ in wrong for place in self._targets(body)],
        )

    def _gets_there(self, scene: Scene, body: Body, plugs: tuple[tuple[float, float, float], ...]) -> bool:
        radius = disc_radius(body, self.size)
        places = [(body.pose[0], body.pose[1]), *self._targets(body)]
        return all(scene.is_reachable(a, b, radius, plugs) for a, b in itertools.pairwise(places))

    def _targets(self, body: Body) -> list[tuple[float, float]]:
        return [(goal[0], goal[1]) for goal in body.goals] if self.to is None else [self.to]


def disc_radius(body: Body, size: Literal["inner", "outer"] = "inner") -> float:
    """Radius of the disc that stands for a body [m]."""
    if body.radius is not None:
        return body.radius
    if size == "outer":
        return float(shapely.minimum_bounding_radius(body.footprint))
    circle = shapely.maximum_inscribed_circle(body.footprint)
    return float(circle.length)
