"""``visits``: bodies come to places in an order, again and again if asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("visits")
class Visits(EpisodePredicate):
    """Every body of a selection comes to some places in the order given. An empty selection fails."""

    of: str
    """Name of the selection."""
    places: list[tuple[Quantity, Quantity]]
    """Places in the order in which they are visited [m]."""
    tol: Quantity = 0.3
    """Greatest distance from a place that counts as being there [m]."""
    laps: int = 1
    """How often the whole list is visited, each time from its first place on."""
    stray: Quantity | None = None
    """Greatest distance of the path from the straight lines between the places, the way back to the first one
    included [m]; default: any."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Follow the paths."""
        bodies = material.bodies(episode.scene, self.of)
        shown = ", ".join(f"({show(x)}, {show(y)})" for x, y in self.places)
        expected = f"{self.of} visit {shown}" + (f", {self.laps} times" if self.laps > 1 else "")
        if self.stray is not None:
            expected += f", at most {show(self.stray)} m off the lines between them"
        if not bodies or not self.places:
            return Observation(False, expected, f"{self.of}: no body")
        found = [(body, self._problem(episode.positions(body.index))) for body in bodies]
        wrong = [(body, text) for body, text in found if text]
        return Observation(
            not wrong,
            expected,
            summary(wrong) or "so it is",
            f"{wrong[0][0].entry}.waypoints" if wrong else None,
            marks=[Mark(points=[list(place)], text="visit") for place in self.places] if wrong else [],
        )

    def _problem(self, way: np.ndarray) -> str:
        """What is wrong with a path; empty if nothing is."""
        row = 0
        for number in range(self.laps * len(self.places)):
            place = np.array(self.places[number % len(self.places)])
            there = np.flatnonzero(np.hypot(*(way[row:] - place).T) <= self.tol)
            if not there.size:
                x, y = place.tolist()
                return f"does not come to ({x:g}, {y:g})" + (f" after {number} visits" if number else "")
            row += int(there[0])
        if self.stray is not None:
            lines = shapely.LineString([*self.places, self.places[0]])
            off = float(shapely.distance(lines, shapely.points(way)).max())
            if off > self.stray:
                return f"gets {show(off)} m off the lines"
        return ""
