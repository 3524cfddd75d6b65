"""The ways from starts to goals: how straight ones lie, what is in the way, and where a free one is narrowest."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Literal, cast

import numpy as np
import shapely

import irsim._core as core
from irsim.common.angles import wrap
from irsim.validation.feasibility.clearance_grid import ClearanceGrid, Gap, cells_over, narrowest_gap
from irsim.validation.feasibility.scenes import StartState
from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import (
    EpisodePredicate,
    Observation,
    OfBodies,
    ScenePredicate,
    judged,
    register,
    travellers,
)  # fmt: skip
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


@register("ways", "relations")
class Ways(OfBodies, ScenePredicate):
    """The straight lines from start to last goal of any two bodies of a selection, of which there must be two."""

    angle: Match | None = None
    """Accepted angles between the directions of two ways [rad]: 0 for the same direction, π for opposite ones."""
    distance: Match | None = None
    """Accepted values of the smallest distance between two ways [m]; 0 where they cross."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Compare all pairs."""
        bodies = travellers(self, material, scene)
        words = []
        if self.angle is not None:
            words.append(f"angle {self.angle.words()} rad")
        if self.distance is not None:
            words.append(f"{self.distance.words()} m apart")
        expected = f"ways of {self.of}: {', '.join(words)}"
        if len(bodies) < 2:
            return Observation(False, expected, f"{len(bodies)} bodies with a goal")
        seen = ""
        for a, b in itertools.combinations(bodies, 2):
            angle, distance = abs(wrap(_direction(a) - _direction(b))), float(shapely.distance(way_of(a), way_of(b)))
            seen = f"{a.name} and {b.name}: {math.degrees(angle):.0f}°, {show(distance)} m apart"
            off = self.angle is not None and not matches(self.angle, angle, "angle")
            far = self.distance is not None and not matches(self.distance, distance, "length")
            if off or far:
                return Observation(False, expected, seen, f"{b.entry}.goal", marks=[_mark(a), _mark(b)])
        return Observation(True, expected, seen)


def _direction(body: GradedBody) -> float:
    goal = body.goal or [*body.pose]
    return math.atan2(goal[1] - body.pose[1], goal[0] - body.pose[0])


def way_of(body: GradedBody) -> shapely.LineString:
    """The straight line from the start of a body to its last goal."""
    return shapely.LineString([body.pose[:2], (body.goal or [*body.pose])[:2]])


def _mark(body: GradedBody) -> Mark:
    return Mark(points=[list(point) for point in way_of(body).coords], text=body.name)


@register("line_of_sight", "relations")
class LineOfSight(OfBodies, ScenePredicate):
    """Whether the straight line from each start to the goal is free. An empty selection fails."""

    clear: bool
    """Whether the line is free of everything solid, or not."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Draw the lines."""
        expected = f"from each of {self.of} to its goal the view is {'clear' if self.clear else 'blocked'}"
        clear = [
            (body, not shapely.intersects(scene.solid, way_of(body))) for body in travellers(self, material, scene)
        ]
        wrong = [(body, value) for body, value in clear if value != self.clear]
        return judged(expected, clear, wrong, "goal", said="clear for ", marks=[_mark(body) for body, _ in wrong])


@register("reachable", "relations")
class Reachable(OfBodies, ScenePredicate):
    """Every body of a selection can get from its start to each of its goals, on a grid of inflated obstacles."""

    size: Literal["inner", "outer"] = "inner"
    """Disc that stands for the body: the largest one inside of it, or the smallest one round it."""
    possible: bool = True
    """Whether there must be a path, or must not."""
    to: tuple[Quantity, Quantity] | None = None
    """A place instead of the goals [m]."""
    plug: tuple[Quantity, Quantity, Quantity] | None = None
    """x, y, radius of a disc that closes a gap first [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Search for paths."""
        bodies = travellers(self, material, scene) if self.to is None else material.bodies(scene, self.of)
        closed = "" if self.plug is None else f" with the gap at ({self.plug[0]:g}, {self.plug[1]:g}) closed"
        target = "its goal" if self.to is None else f"({self.to[0]:g}, {self.to[1]:g})"
        expected = f"each of {self.of} {'can' if self.possible else 'cannot'} get to {target}{closed}"
        plugs = () if self.plug is None else (self.plug,)
        for body in bodies:
            why = self._no_place(scene, body)
            if why:
                return Observation(False, expected, f"{body.name}: {why}", f"{body.entry}.goal")
        results = [(body, self._gets_there(scene, body, plugs)) for body in bodies]
        wrong = [(body, value) for body, value in results if value != self.possible]
        marks = [Mark(points=[list(place)], text=body.name) for body, _ in wrong for place in self._targets(body)]
        return judged(expected, results, wrong, "goal", said="a path for ", marks=marks)

    def _no_place(self, scene: GradedScene, body: GradedBody) -> str:
        """The reason why a body cannot stand at an end of its way, so that no search is needed; empty if it can."""
        x0, y0, x1, y1 = scene.bounds
        radius = disc_radius(body, self.size)
        for x, y in [(body.pose[0], body.pose[1]), *self._targets(body)]:
            if not (x0 <= x <= x1 and y0 <= y <= y1):
                return f"({x:g}, {y:g}) lies outside of the world"
            if not self.possible and not scene.is_free((x, y), radius):
                return f"there is no room for it at ({x:g}, {y:g})"
        return ""

    def _gets_there(self, scene: GradedScene, body: GradedBody, plugs: tuple[tuple[float, float, float], ...]) -> bool:
        radius = disc_radius(body, self.size)
        places = [(body.pose[0], body.pose[1]), *self._targets(body)]
        return all(scene.is_reachable(a, b, radius, plugs) for a, b in itertools.pairwise(places))

    def _targets(self, body: GradedBody) -> list[tuple[float, float]]:
        return [(goal[0], goal[1]) for goal in body.goals] if self.to is None else [self.to]


def disc_radius(body: GradedBody, size: Literal["inner", "outer"] = "inner") -> float:
    """Radius of the disc that stands for a body [m]."""
    if body.radius is not None:
        return body.radius
    if size == "outer":
        return float(shapely.minimum_bounding_radius(body.footprint))
    circle = shapely.maximum_inscribed_circle(body.footprint)
    return float(circle.length)


@register("bottleneck", "relations")
class Bottleneck(OfBodies, ScenePredicate):
    """The width of the narrowest place that every body of a selection must pass on its way from its start over its
    goals, where it goes the widest way. How close it stands to a wall at its start or at a goal does not matter, and
    the edge of the world counts as a wall. An empty selection fails."""

    width: Match = Match(ge=0)
    """Accepted widths of the narrowest place [m]; 0 where there is no way."""
    only: bool = False
    """Whether closing this place must close every way."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure the gaps."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goals]
        expected = f"the {'only' * self.only or 'narrowest'} place on the way of {self.of}: {self.width.words()} m wide"
        places = [(body, _narrowest(scene, body)) for body in bodies]
        wrong = [
            pair
            for pair in places
            if not (matches(self.width, pair[1].width, "length") and self._is_only(scene, *pair))
        ]
        marks = [Mark(points=[list(place.place)], text=f"{place.width:.2f} m") for _, place in wrong]
        words, odd = ([(body, f"{show(place.width)} m at {show(list(place.place))}") for body, place in pairs]
                      for pairs in (places, wrong))  # fmt: skip
        return judged(expected, words, odd, "goal", marks=marks)

    def _is_only(self, scene: GradedScene, body: GradedBody, gap: Gap) -> bool:
        """Whether there is no way to the last goal once the gap is closed, where that is asked for."""
        (x, y), plug = body.goals[-1][:2], (*gap.place, 0.6 * gap.width)
        return not self.only or not scene.is_reachable(body.pose[:2], (x, y), disc_radius(body), (plug,))


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
    if (body.index, "narrowest") not in scene.kept:
        scene.kept[body.index, "narrowest"] = _measured(scene, body)
    return cast(Gap, scene.kept[body.index, "narrowest"])


def _measured(scene: GradedScene, body: GradedBody) -> Gap:
    x0, y0, x1, y1 = scene.bounds
    edge = core.Linestring(vertices=[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]])
    start = StartState(scene.seed, {}, {}, [*scene.things, ([edge], [0.0, 0.0, 0.0])], scene.bounds)
    cells = cells_over(scene.bounds, disc_radius(body) / _CELLS_PER_RADIUS, _MAX_CELLS)
    clearance = core.Clearance(start.terrain, cells)
    grid = ClearanceGrid(start, scene.bounds, cells, clearance, math.sqrt(0.5) * max(cells[1]))
    places = [clearance.climb(place[:2], math.hypot(x1 - x0, y1 - y0)) for place in (body.pose, *body.goals)]
    gaps = [narrowest_gap(grid, a, b) or Gap(0.0, b, 0.0) for a, b in dict.fromkeys(itertools.pairwise(places))]
    return min(gaps, key=lambda gap: gap.width)
