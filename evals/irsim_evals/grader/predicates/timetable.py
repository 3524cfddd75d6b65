"""``timetable``: when bodies cross a line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Quantity, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("timetable")
class Timetable(EpisodePredicate):
    """The bodies of a selection cross a line at given times, each of them once."""

    of: str
    """Name of the selection."""
    start: tuple[Quantity, Quantity]
    """One end of the line [m]."""
    end: tuple[Quantity, Quantity]
    """The other end [m]."""
    times: list[Quantity]
    """When the first, the second, … of them crosses it [s]."""
    tol: Quantity = 0.5
    """Greatest deviation from these times [s]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Look for the crossings."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} cross the line {show(list(self.start))} to {show(list(self.end))} after "
        expected += ", ".join(f"{time:g} s" for time in self.times)
        found = sorted(
            ((time, body) for body in bodies for time in self._crossings(episode, body.index)),
            key=lambda crossing: crossing[0],
        )
        passed = len(found) == len(self.times) == len({body.name for _, body in found})
        passed = passed and all(abs(a - b) <= self.tol + 1e-9 for (a, _), b in zip(found, self.times, strict=True))
        return Observation(
            passed,
            expected,
            summary([(body, f"{time:.1f} s") for time, body in found]) or f"none of {len(bodies)}",
            f"{bodies[0].entry}.state" if bodies else None,
            marks=[Mark(points=[list(self.start), list(self.end)], text="line")],
        )

    def _crossings(self, episode: Episode, index: int) -> list[float]:
        length = math.dist(self.start, self.end) or 1.0
        unit = (np.array(self.end) - self.start) / length
        offset = episode.positions(index) - np.array(self.start)
        aside, along = unit[0] * offset[:, 1] - unit[1] * offset[:, 0], offset @ unit
        rows = np.flatnonzero((aside[1:] > 0) != (aside[:-1] > 0))
        return [float(episode.trace.time[row + 1]) for row in rows if 0 <= along[row] <= length]
