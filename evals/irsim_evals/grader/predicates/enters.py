"""``enters``: bodies come into some regions, one after the other, and never into others."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("enters")
class Enters(EpisodePredicate):
    """Every body of a selection comes into each region in this order. An empty selection fails."""

    of: str
    """Name of the selection."""
    regions: list[tuple[Quantity, Quantity, Quantity, Quantity]]
    """x0, y0, x1, y1 of each region [m]."""
    avoids: list[tuple[Quantity, Quantity, Quantity, Quantity]] = []
    """Regions that its position never comes into [m]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Follow every body."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} comes into " + ", ".join(show(list(region)) for region in self.regions)
        expected += "".join(f", never into {show(list(region))}" for region in self.avoids)
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        wrong = [(body, why) for body in bodies if (why := self._why_not(episode.positions(body.index)))]
        return Observation(
            not wrong,
            expected,
            summary(wrong) if wrong else f"all {len(bodies)}",
            f"{wrong[0][0].entry}.goal" if wrong else None,
            marks=[Mark(points=episode.positions(body.index)[::20].tolist(), text=body.name) for body, _ in wrong],
        )

    def _why_not(self, way: np.ndarray) -> str:
        row = 0
        for region in self.regions:
            rows = np.flatnonzero(_within(way[row:], region))
            if not rows.size:
                return f"does not come to {show(list(region))}" + (" after the others" if row else "")
            row += int(rows[0])
        return next((f"comes into {show(list(r))}" for r in self.avoids if _within(way, r).any()), "")


def _within(way: np.ndarray, region: tuple[float, float, float, float]) -> np.ndarray:
    x0, y0, x1, y1 = region
    found: np.ndarray = (way[:, 0] >= x0) & (way[:, 0] <= x1) & (way[:, 1] >= y0) & (way[:, 1] <= y1)
    return found
