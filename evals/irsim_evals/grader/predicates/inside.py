"""``inside``: bodies or their goals lie in a region."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import shapely

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("inside")
class Inside(ScenePredicate):
    """Every body of a selection lies in a region. An empty selection fails."""

    stage = "relations"

    of: str
    """Name of the selection."""
    what: Literal["position", "footprint", "goal"] = "position"
    """What lies in the region: its position, its whole footprint, or each of its goals."""
    region: tuple[Quantity, Quantity, Quantity, Quantity] | None = None
    """x0, y0, x1, y1 [m]; default: the world."""
    shares: tuple[Quantity, Quantity, Quantity, Quantity] | None = None
    """The same as shares of the world's extent: ``[0, 0, 0.33, 0.33]`` is its lower left third."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Look at each of them."""
        bodies = material.bodies(scene, self.of)
        x0, y0, x1, y1 = self._box(scene)
        expected = f"{self.what} of {self.of} within x {show(x0)} to {show(x1)}, y {show(y0)} to {show(y1)}"
        wrong = [
            (body, point) for body in bodies for point in self._points(body) if not _holds((x0, y0, x1, y1), point)
        ]
        missing = [body for body in bodies if not self._points(body)]
        if not bodies or missing:
            return Observation(False, expected, f"{missing[0].name}: no goal" if missing else f"{self.of}: no body")
        key = "goal" if self.what == "goal" else "state"
        return Observation(
            not wrong,
            expected,
            summary(wrong) if wrong else f"all {len(bodies)}",
            f"{wrong[0][0].entry}.{key}" if wrong else None,
            marks=[Mark(points=[list(point)], text=body.name) for body, point in wrong],
        )

    def _box(self, scene: Scene) -> tuple[float, float, float, float]:
        if self.region is not None:
            return self.region
        x0, y0, x1, y1 = scene.bounds
        a, b, c, d = self.shares or (0.0, 0.0, 1.0, 1.0)
        return x0 + a * (x1 - x0), y0 + b * (y1 - y0), x0 + c * (x1 - x0), y0 + d * (y1 - y0)

    def _points(self, body: Body) -> list[tuple[float, float]]:
        if self.what == "goal":
            return [(goal[0], goal[1]) for goal in body.goals]
        if self.what == "footprint":
            return [(float(x), float(y)) for x, y in shapely.get_coordinates(body.footprint)]
        return [body.position]


def _holds(box: tuple[float, float, float, float], point: tuple[float, float]) -> bool:
    return box[0] - 1e-6 <= point[0] <= box[2] + 1e-6 and box[1] - 1e-6 <= point[1] <= box[3] + 1e-6
