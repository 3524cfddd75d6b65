"""Which places, regions and lines bodies come to in an episode, in which order and when."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import shapely
from pydantic import model_validator

from irsim_evals.grader.matching import Counted, Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, judged, register, summary
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material

_LEFT = 0.05
"""Distance [m] from its start at which a body has left it."""
Place = tuple[Quantity, Quantity] | tuple[Quantity, Quantity, Quantity, Quantity]
"""A point x, y or a region x0, y0, x1, y1 [m]."""


@register("visits")
class Visits(OfBodies, EpisodePredicate):
    """Every body of a selection comes to some places in the order given, and to none of them out of turn, unless it
    lies on the straight way between two others. An empty selection fails."""

    places: list[Place]
    """Places in the order in which they are visited: a point x, y or a region x0, y0, x1, y1 [m]."""
    tol: Quantity = 0.3
    """Greatest distance from a point that counts as being there [m]."""
    laps: Counted = 1
    """How often the whole list is visited, each time from its first place on."""
    avoids: list[Place] = []
    """Places to which it never comes [m]."""
    stray: Quantity | None = None
    """Greatest distance of the path from the straight lines between the places, the way back to the first one
    included [m]; default: any."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Follow the paths."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} visit " + ", ".join(map(_words, self.places))
        expected += f", {self.laps} times" if self.laps > 1 else ""
        expected += "".join(f", never {_words(place)}" for place in self.avoids)
        if self.stray is not None:
            expected += f", at most {show(self.stray)} m off the lines between them"
        problems = [(body, self._problem(episode.path(body.index))) for body in bodies]
        wrong = [(body, text) for body, text in problems if text]
        spots = [[shape.x, shape.y] for shape in (_shape(place).centroid for place in self.places)]
        marks = [Mark(points=[spot], text="visit") for spot in spots] if wrong else []
        return judged(expected, problems, wrong, "waypoints", right="so it is", marks=marks)

    def _problem(self, way: np.ndarray) -> str:
        """The problem of a path; empty if it is right."""
        near = self._near(way, self.places)
        begins = np.flatnonzero(near[0] & ~np.concatenate([[False], near[0, :-1]])).tolist()
        results = [self._follow(near[:, row:]) for row in begins] or [(0, self._missing(0))]
        if all(text for _, text in results):
            return max(results)[1]
        if self.avoids and (never := self._near(way, self.avoids).any(axis=1)).any():
            return f"comes to {_words(self.avoids[int(never.argmax())])}"
        if self.stray is not None:
            lines = shapely.LineString([_shape(place).centroid for place in (*self.places, self.places[0])])
            off = float(shapely.distance(lines, shapely.points(way)).max())
            if off > self.stray:
                return f"gets {show(off)} m off the lines"
        return ""

    def _near(self, way: np.ndarray, places: list[Place]) -> np.ndarray:
        """(P, T) whether a path is at each place."""
        points = shapely.points(way)
        return np.array([shapely.distance(_shape(place), points) <= self._reach(place) for place in places])

    def _reach(self, place: Place) -> float:
        return self.tol if len(place) == 2 else 0.0

    def _follow(self, near: np.ndarray) -> tuple[int, str]:
        """Number of visits in the right order, and the problem of the next one; empty if all are made.

        Args:
            near: (P, T) whether a body is at each place, from a visit of the first place on.
        """
        row, count = 0, len(self.places)
        for number in range(1, self.laps * count):
            here, there = (number - 1) % count, number % count
            rows = np.flatnonzero(near[there, row:])
            if not rows.size:
                return number, self._missing(number)
            line = shapely.LineString([_shape(self.places[k]).centroid for k in (here, there)])
            for k, place in enumerate(self.places):
                beside = shapely.distance(line, _shape(place)) > 2 * self._reach(place)
                if beside and near[k, row : row + int(rows[0])].any():
                    return number, f"comes to {_words(place)} out of turn after {number} visits"
            row += int(rows[0])
        return self.laps * count, ""

    def _missing(self, number: int) -> str:
        place = self.places[number % len(self.places)]
        return f"does not come to {_words(place)}" + (f" after {number} visits" if number else "")


def _shape(place: Place) -> Any:
    """The point, or the rectangle, that a place is."""
    return shapely.Point(place) if len(place) == 2 else shapely.box(*place)


def _words(place: Place) -> str:
    return f"({', '.join(map(show, place))})"


def _within(way: np.ndarray, region: tuple[float, float, float, float]) -> np.ndarray:
    x0, y0, x1, y1 = region
    inside: np.ndarray = (way[:, 0] >= x0) & (way[:, 0] <= x1) & (way[:, 1] >= y0) & (way[:, 1] <= y1)
    return inside


@register("one_way")
class OneWay(OfBodies, EpisodePredicate):
    """How many bodies of a selection pass through a region in one direction; none may go against it."""

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

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Follow every body through the region."""
        bodies = self.bodies(material, episode.scene)
        degrees = math.degrees(self.direction)
        expected = f"{self.of} that pass through {show(list(self.region))} toward {show(degrees)}°: "
        expected += f"{self.number.words()}, none the other way"
        x0, y0, x1, y1 = self.region
        unit = np.array([math.cos(self.direction), math.sin(self.direction)])
        extent = abs(unit[0]) * (x1 - x0) + abs(unit[1]) * (y1 - y0)
        passed, against = [], []
        for body in bodies:
            way = episode.path(body.index)
            far, rows = way @ unit, np.flatnonzero(_within(way, self.region))
            stays = [far[stay] for stay in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if stay.size]
            if any(float((np.maximum.accumulate(stay) - stay).max()) > self.back for stay in stays):
                against.append((body, "goes the other way"))
            elif any(float(np.ptp(stay)) >= self.most * extent for stay in stays):
                passed.append((body, "passes"))
        right = not against and matches(self.number, len(passed), "count")
        seen, where = summary([*against, *passed]), f"{against[0][0].entry}.goal" if against else None
        marks = [Mark(points=[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], text="one way")]
        return Observation(right, expected, f"{len(passed)}; {seen}", where, marks=marks)


@register("crosses")
class Crosses(OfBodies, EpisodePredicate):
    """Bodies of a selection cross a line from one side to the other. An empty selection fails."""

    line: tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity]] | None = None
    """The two ends of the line [m]."""
    way_of: Selection | None = None
    """Selection of one body instead: the line is that through its start and its goal."""
    ahead: bool = True
    """Of that line only what lies between the body and its goal at the time counts."""
    driving: bool = False
    """Only crossings count after that body has left its start."""
    direction: Literal["left_to_right", "right_to_left"] | None = None
    """Only those count that cross so, seen from the first end toward the second, or by the body."""
    number: Match | None = None
    """Accepted numbers of bodies that cross."""
    spread: Quantity = 0.0
    """Least time between the first and the last body that crosses [s]."""
    times: list[Quantity] | None = None
    """When the first, the second, … of them crosses [s]; then none may cross twice."""
    tol: Quantity = 0.5
    """Greatest deviation from these times [s]."""

    @model_validator(mode="after")
    def _one(self) -> Crosses:
        if (self.line is None) == (self.way_of is None):
            raise ValueError("give either `line` or `way_of`")
        if self.number is None and self.times is None:
            raise ValueError("say how many bodies cross with `number`, or when with `times`")
        return self

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look for changes of side."""
        bodies = material.bodies(episode.scene, self.of)
        ways = [] if self.way_of is None else material.bodies(episode.scene, self.way_of)
        where = f"{'ahead' if self.ahead else 'the way'} of {self.way_of}"
        where = where if self.line is None else f"the line {show(list(map(list, self.line)))}"
        expected = f"{self.of} that cross {where}" + (f": {self.number.words()}" if self.number is not None else "")
        expected += f", over at least {self.spread:g} s" if self.spread else ""
        expected += "".join(f", after {time:g} s" for time in self.times or ())
        if not bodies or (self.line is None and (len(ways) != 1 or ways[0].goal is None)):
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.way_of}: {len(ways)}")
        start, end = self.line or (ways[0].pose[:2], tuple((ways[0].goal or [])[:2]))
        front: Any = np.full(len(episode.trace), -1e-9)
        if ways:
            unit = (np.array(end) - start) / (math.dist(start, end) or 1.0)
            own = (episode.positions(ways[0].index) - start) @ unit
            front = own if self.ahead else front - math.inf
            front = np.where(own > _LEFT, front, math.inf) if self.driving else front
        all_times = [(body, self._times(episode, body, start, end, front)) for body in bodies]
        crossed = sorted(((times[0], body) for body, times in all_times if times), key=lambda crossing: crossing[0])
        spread = crossed[-1][0] - crossed[0][0] if crossed else 0.0
        passed = (self.number is None or matches(self.number, len(crossed), "count")) and spread >= self.spread - 1e-9
        if self.times is not None:
            passed = passed and len(crossed) == len(self.times) == sum(len(times) for _, times in all_times)
            pairs = zip(crossed, self.times, strict=True)
            passed = passed and all(abs(at - wanted) <= self.tol + 1e-9 for (at, _), wanted in pairs)
        seen = summary([(body, f"{time:.1f} s") for time, body in crossed])
        marks = [Mark(points=[list(start), list(end)], text="line")]
        return Observation(passed, expected, f"{len(crossed)}: {seen}", f"{bodies[0].entry}.state", marks=marks)

    def _times(self, episode: GradedEpisode, body: GradedBody, start: Any, end: Any, front: Any) -> list[float]:
        """Times at which a body crosses the line, where it is farther along it than ``front`` at the time [s]."""
        length = math.dist(start, end) or 1.0
        unit = (np.array(end) - start) / length
        offset = episode.positions(body.index) - np.array(start)
        left, far = unit[0] * offset[:, 1] - unit[1] * offset[:, 0], offset @ unit
        most = math.inf if self.line is None and not self.ahead else length
        rows = np.flatnonzero((left[1:] > 0) != (left[:-1] > 0))
        return [
            float(episode.trace.time[row + 1])
            for row in rows.tolist()
            if front[row] < far[row] <= most
            and self.direction in (None, "right_to_left" if left[row + 1] > 0 else "left_to_right")
        ]
