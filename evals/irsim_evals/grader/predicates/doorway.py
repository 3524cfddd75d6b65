"""``doorway``: a line that is solid but for some openings."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, ScenePredicate, register
from irsim_evals.grader.rays import along, free_parts

if TYPE_CHECKING:
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("doorway")
class Doorway(ScenePredicate):
    """A line of the world is solid but for some openings."""

    stage = "relations"

    start: tuple[Quantity, Quantity]
    """One end of the line [m]."""
    end: tuple[Quantity, Quantity]
    """The other end [m]."""
    depth: Quantity = 0.2
    """What is solid at most this far beside the line counts as on it [m]."""
    openings: Match = Match(eq=1)
    """Accepted numbers of openings."""
    width: Match | None = None
    """Accepted widths of each opening [m]."""
    middles: list[tuple[Quantity, Quantity]] = []
    """Middle of each opening in order from ``start`` [m]."""
    tol: Quantity = 0.2
    """Greatest distance of an opening's middle from the wanted one [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Look for openings."""
        parts = free_parts(scene.solid, self.start, self.end, self.depth)
        heading = math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])
        spots = [along(self.start, heading, (a + b) / 2) for a, b in parts]
        widths = [b - a for a, b in parts]
        expected = f"openings from {show(list(self.start))} to {show(list(self.end))}: {self.openings.words()}"
        if self.width is not None:
            expected += f", {self.width.words()} m wide"
        observed = ", ".join(f"{w:.2f} m at ({x:.2f}, {y:.2f})" for w, (x, y) in zip(widths, spots, strict=True))
        passed = matches(self.openings, len(parts), "count")
        if self.width is not None:
            passed = passed and all(matches(self.width, width, "length") for width in widths)
        if self.middles:
            expected += f", in the middle {show([list(p) for p in self.middles])}"
            passed = passed and len(self.middles) == len(spots)
            passed = passed and all(math.dist(a, b) <= self.tol for a, b in zip(spots, self.middles, strict=True))
        marks = [] if passed else [Mark(points=[list(self.start), list(self.end)], text=observed or "solid")]
        return Observation(passed, expected, observed or "no opening", marks=marks)
