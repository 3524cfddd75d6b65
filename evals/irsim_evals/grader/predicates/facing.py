"""``facing``: where bodies look: toward a place, another selection, their goal, or a direction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

from irsim.common.angles import wrap
from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene

_DIRECTIONS = {"east": 0.0, "north": math.pi / 2, "west": math.pi, "south": -math.pi / 2}


@register("facing")
class Facing(ScenePredicate):
    """Every body of a selection looks somewhere. An empty selection fails."""

    stage = "relations"

    of: str
    """Name of the selection."""
    toward: str | tuple[Quantity, Quantity] | Literal["goal"]
    """``goal``, ``north``, ``east``, ``south``, ``west``, a place [m], or the name of a selection: its middle."""
    tol: Quantity = math.radians(20)
    """Greatest deviation [rad]."""
    away: bool = False
    """It looks the other way."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure the angles."""
        bodies = material.bodies(scene, self.of)
        where = self.toward if isinstance(self.toward, str) else show(list(self.toward))
        expected = f"{self.of} {'away from' if self.away else 'toward'} {where}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        found = [(body, self._off(material, scene, body)) for body in bodies]
        wrong = [(body, off) for body, off in found if off is None or off > self.tol + 1e-9]
        degrees = [(body, None if off is None else f"{math.degrees(off):.0f}° off") for body, off in wrong or found]
        return Observation(not wrong, expected, summary(degrees), f"{wrong[0][0].entry}.state" if wrong else None)

    def _off(self, material: Material, scene: Scene, body: Body) -> float | None:
        if self.toward == "goal":
            target = None if body.goal is None else (body.goal[0], body.goal[1])
        elif isinstance(self.toward, str) and self.toward in _DIRECTIONS:
            return _apart(_DIRECTIONS[self.toward] + (math.pi if self.away else 0.0), body.pose[2])
        elif isinstance(self.toward, str):
            others = [other for other in material.bodies(scene, self.toward) if other is not body]
            places = [other.position for other in others]
            target = (
                (sum(x for x, _ in places) / len(places), sum(y for _, y in places) / len(places)) if places else None
            )
        else:
            target = self.toward
        if target is None:
            return None
        wanted = math.atan2(target[1] - body.pose[1], target[0] - body.pose[0]) + (math.pi if self.away else 0.0)
        return _apart(wanted, body.pose[2])


def _apart(a: float, b: float) -> float:
    return float(abs(wrap(a - b)))
