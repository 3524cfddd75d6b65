"""The narrowest place on the way of a body, and who passes it first."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Literal

import numpy as np

import irsim._core as core
from irsim.validation.feasibility.clearance_grid import ClearanceGrid, Gap, cells_over, narrowest_gap
from irsim.validation.feasibility.scenes import StartState
from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import (
    EpisodePredicate,
    Observation,
    OfBodies,
    ScenePredicate,
    judged,
    register,
)  # fmt: skip
from irsim_evals.grader.predicates.ways import disc_radius
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

_CELLS_PER_RADIUS = 4
"""Cells along the radius of the body, unless that takes too many cells."""
_MAX_CELLS = 150_000
"""Greatest number of cells over the world."""


@register("bottleneck", "relations")
class Bottleneck(OfBodies, ScenePredicate):
    """The width of the narrowest place that every body of a selection must pass on its way from its start over its
    goals, where it goes the widest way. How close it stands to a wall at its start or at a goal does not matter, and
    the edge of the world counts as a wall. An empty selection fails."""

    width: Match
    """Accepted widths of the narrowest place [m]; 0 where there is no way."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure the gaps."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goals]
        expected = f"the narrowest place on the way of {self.of}: {self.width.words()} m wide"
        places = [(body, _narrowest(scene, body)) for body in bodies]
        wrong = [(body, place) for body, place in places if not matches(self.width, place.width, "length")]
        marks = [Mark(points=[list(place.place)], text=f"{place.width:.2f} m") for _, place in wrong]
        words, odd = ([(body, f"{show(place.width)} m at {show(list(place.place))}") for body, place in pairs]
                      for pairs in (places, wrong))  # fmt: skip
        return judged(expected, words, odd, "goal", marks=marks)


@register("before")
class Before(OfBodies, EpisodePredicate):
    """Every body of a selection passes the narrowest place on its way, or arrives, before any body of another selection
    does. An empty selection fails."""

    to: Selection
    """Name of the selection of those who come later."""
    what: Literal["bottleneck", "goal"] = "bottleneck"
    """The place: see `bottleneck`; who comes there several times passes it the last time."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Compare the times."""
        first, later = (material.bodies(episode.scene, name) for name in (self.of, self.to))
        times = {body.name: self._time(episode, body) for body in (*first, *later)}
        begin = min((times[body.name] for body in later), default=-math.inf)
        seen = [(body, f"{times[body.name]:.1f} s") for body in (*first, *later)]
        wrong = [pair for pair in seen[: len(first)] if not times[pair[0].name] < begin]
        expected = f"{self.of} pass the {self.what} before {self.to}, who come there after {begin:.1f} s"
        return judged(expected, seen, wrong if later else seen, "behavior")

    def _time(self, episode: GradedEpisode, body: GradedBody) -> float:
        """When a body passes the place [s]; never is infinite."""
        if self.what == "goal":
            return episode.arrival(body.name) or math.inf
        gap = _narrowest(episode.scene, body) if body.goals else Gap(0.0, (math.inf, math.inf), 0.0)
        far = np.hypot(*(episode.positions(body.index) - gap.place[:2]).T)
        return float(max(episode.trace.time[far <= gap.width / 2], default=math.inf))


def _narrowest(scene: GradedScene, body: GradedBody) -> Gap:
    """The narrowest place on the widest way of a body over its goals."""
    x0, y0, x1, y1 = scene.bounds
    edge = core.Linestring(vertices=[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
    start = StartState(scene.seed, {}, {}, [*scene.things, ([edge], [0.0, 0.0, 0.0])], scene.bounds)
    cells = cells_over(scene.bounds, disc_radius(body) / _CELLS_PER_RADIUS, _MAX_CELLS)
    clearance = core.Clearance(start.terrain, cells)
    grid = ClearanceGrid(start, scene.bounds, cells, clearance, math.sqrt(0.5) * max(cells[1]))
    places = [clearance.climb(place[:2], math.hypot(x1 - x0, y1 - y0)) for place in (body.pose, *body.goals)]
    gaps = [narrowest_gap(grid, a, b) or Gap(0.0, b, 0.0) for a, b in itertools.pairwise(places)]
    return min(gaps, key=lambda gap: gap.width)
