"""``on_circle``: bodies stand on a circle, evenly spaced, each with its goal opposite if so wanted."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim.common.angles import wrap
from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("on_circle")
class OnCircle(ScenePredicate):
    """Every body of a selection stands on a circle."""

    stage = "relations"

    of: str
    """Name of the selection."""
    center: tuple[Quantity, Quantity] | None = None
    """Middle of the circle [m]; default: the mean of the positions."""
    center_near: tuple[Quantity, Quantity, Quantity] | None = None
    """x, y and the greatest distance of the middle from there [m]."""
    radius: Quantity
    """Radius of the circle [m]."""
    tol: Quantity = 0.05
    """Greatest deviation from the radius [m]."""
    even: Quantity | None = None
    """Greatest deviation of the angles between neighbours from an even spacing [rad]."""
    opposite: Quantity | None = None
    """Greatest distance of each goal from the point opposite of the start [m]."""
    facing: Quantity | None = None
    """Greatest deviation of each heading from the direction to the middle [rad]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure radii, angles and goals."""
        bodies = material.bodies(scene, self.of)
        expected = f"{self.of} on a circle of radius {show(self.radius)} m"
        if len(bodies) < 2:
            return Observation(False, expected, f"{len(bodies)} bodies")
        places = [body.position for body in bodies]
        cx, cy = self.center or (sum(x for x, _ in places) / len(places), sum(y for _, y in places) / len(places))
        wrong: list[str] = []
        marks: list[Mark] = []
        if self.center_near is not None and math.dist((cx, cy), self.center_near[:2]) > self.center_near[2]:
            wrong.append(f"its middle is ({cx:.2f}, {cy:.2f})")
        for body, place in zip(bodies, places, strict=True):
            radius = math.dist(place, (cx, cy))
            if abs(radius - self.radius) > self.tol + 1e-9:
                wrong.append(f"{body.name} is {radius:.2f} m from ({cx:.2f}, {cy:.2f})")
                marks.append(Mark(points=[[cx, cy], list(place)], text=body.name))
            if self.opposite is not None:
                goal = body.goal
                there = (2 * cx - place[0], 2 * cy - place[1])
                if goal is None or math.dist(goal[:2], there) > self.opposite + 1e-9:
                    wrong.append(f"the goal of {body.name} is {show(goal)}, opposite is {show(list(there))}")
                    marks.append(Mark(points=[list(there)], text=f"opposite of {body.name}"))
            if self.facing is not None:
                off = math.atan2(cy - place[1], cx - place[0]) - body.pose[2]
                off = abs(wrap(off))
                if off > self.facing + 1e-9:
                    wrong.append(f"{body.name} looks {math.degrees(off):.0f}° past the middle")
        if self.even is not None:
            angles = sorted(math.atan2(y - cy, x - cx) for x, y in places)
            gaps = [b - a for a, b in zip(angles, [*angles[1:], angles[0] + 2 * math.pi], strict=True)]
            worst = max(abs(gap - 2 * math.pi / len(gaps)) for gap in gaps)
            if worst > self.even + 1e-9:
                wrong.append(f"the angles between neighbours are off by up to {math.degrees(worst):.1f}°")
        observed = "; ".join(wrong[:3]) if wrong else f"all {len(bodies)}"
        return Observation(not wrong, expected, observed, f"{bodies[0].entry}.state" if wrong else None, marks=marks)
