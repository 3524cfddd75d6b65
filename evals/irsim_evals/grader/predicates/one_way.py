"""``one_way``: bodies that pass through a region pass through it in one direction only."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("one_way")
class OneWay(EpisodePredicate):
    """How many bodies of a selection pass through a region in one direction; none may go against it."""

    of: str
    """Name of the selection."""
    region: tuple[Quantity, Quantity, Quantity, Quantity]
    """x0, y0, x1, y1 of the region [m]."""
    direction: Quantity
    """The direction [rad]."""
    number: Match
    """Accepted numbers of bodies that pass. A body has passed if it came as far as `most` of the region's extent in
    the direction."""
    most: Quantity = 0.9
    """Share of the extent that counts as having passed."""
    back: Quantity = 0.1
    """Greatest distance that a body may come back within the region [m]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Follow every body through the region."""
        bodies = material.bodies(episode.scene, self.of)
        degrees = math.degrees(self.direction)
        expected = f"{self.of} that pass through {show(list(self.region))} toward {show(degrees)}°: "
        expected += f"{self.number.words()}, none the other way"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        x0, y0, x1, y1 = self.region
        unit = np.array([math.cos(self.direction), math.sin(self.direction)])
        extent = abs(unit[0]) * (x1 - x0) + abs(unit[1]) * (y1 - y0)
        passed, against = [], []
        for body in bodies:
            way = episode.positions(body.index)
            inside = (way[:, 0] >= x0) & (way[:, 0] <= x1) & (way[:, 1] >= y0) & (way[:, 1] <= y1)
            far = (way @ unit)[inside]
            if not far.size:
                continue
            if float((np.maximum.accumulate(far) - far).max()) > self.back:
                against.append((body, "goes the other way"))
            elif float(far.max() - far.min()) >= self.most * extent:
                passed.append((body, "passes"))
        return Observation(
            not against and matches(self.number, len(passed), "count"),
            expected,
            f"{len(passed)}; " + summary([*against, *passed]),
            f"{against[0][0].entry}.goal" if against else None,
            marks=[Mark(points=[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], text="one way")],
        )
