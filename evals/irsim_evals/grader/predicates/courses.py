"""Which places, regions and lines bodies come to in an episode, in which order and when."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np
import shapely

from irsim_evals.grader.matching import Counted, Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, judged, register, summary
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material

_LEFT = 0.05
"""Distance [m] from its start at which a body has left it."""


@register("visits")
class Visits(OfBodies, EpisodePredicate):
    """Every body of a selection comes to some places in the order given, and to none of them out of turn, unless it
    lies on the straight way between two others. An empty selection fails."""

    places: list[tuple[Quantity, Quantity]]
    """Places in the order in which they are visited [m]."""
    tol: Quantity = 0.3
    """Greatest distance from a place that counts as being there [m]."""
    laps: Counted = 1
    """How often the whole list is visited, each time from its first place on."""
    stray: Quantity | None = None
    """Greatest distance of the path from the straight lines between the places, the way back to the first one
    included [m]; default: any."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Follow the paths."""
        bodies = material.bodies(episode.scene, self.of)
        shown = ", ".join(f"({show(x)}, {show(y)})" for x, y in self.places)
        expected = f"{self.of} visit {shown}" + (f", {self.laps} times" if self.laps > 1 else "")
        if self.stray is not None:
            expected += f", at most {show(self.stray)} m off the lines between them"
        problems = [(body, self._problem(episode.path(body.index))) for body in bodies]
        wrong = [(body, text) for body, text in problems if text]
        marks = [Mark(points=[list(place)], text="visit") for place in self.places] if wrong else []
        return judged(expected, problems, wrong, "waypoints", right="so it is", marks=marks)

    def _problem(self, way: np.ndarray) -> str:
        """The problem of a path; empty if it is right."""
        near = np.array([np.hypot(*(way - np.array(place)).T) <= self.tol for place in self.places])
        begins = np.flatnonzero(near[0] & ~np.concatenate([[False], near[0, :-1]])).tolist()
        results = [self._follow(near[:, row:]) for row in begins] or [(0, self._missing(0))]
        if all(text for _, text in results):
            return max(results)[1]
        if self.stray is not None:
            lines = shapely.LineString([*self.places, self.places[0]])
            off = float(shapely.distance(lines, shapely.points(way)).max())
            if off > self.stray:
                return f"gets {show(off)} m off the lines"
        return ""

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
            line = shapely.LineString([self.places[here], self.places[there]])
            for k in range(count):
                beside = shapely.distance(line, shapely.Point(self.places[k])) > 2 * self.tol
                if beside and near[k, row : row + int(rows[0])].any():
                    x, y = self.places[k]
                    return number, f"comes to ({x:g}, {y:g}) out of turn after {number} visits"
            row += int(rows[0])
        return self.laps * count, ""

    def _missing(self, number: int) -> str:
        x, y = self.places[number % len(self.places)]
        return f"does not come to ({x:g}, {y:g})" + (f" after {number} visits" if number else "")


@register("enters")
class Enters(OfBodies, EpisodePredicate):
    """Every body of a selection comes into each region in this order. An empty selection fails."""

    regions: list[tuple[Quantity, Quantity, Quantity, Quantity]]
    """x0, y0, x1, y1 of each region [m]."""
    avoids: list[tuple[Quantity, Quantity, Quantity, Quantity]] = []
    """Regions that its position never comes into [m]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Follow every body."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} comes into " + ", ".join(show(list(region)) for region in self.regions)
        expected += "".join(f", never into {show(list(region))}" for region in self.avoids)
        problems = [(body, self._why_not(episode.path(body.index))) for body in bodies]
        wrong = [(body, why) for body, why in problems if why]
        marks = [Mark(points=episode.positions(body.index)[::20].tolist(), text=body.name) for body, _ in wrong]
        return judged(expected, problems, wrong, "goal", right=f"all {len(bodies)}", marks=marks)

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
            way = episode.path(body.index)
            far, rows = way @ unit, np.flatnonzero(_within(way, self.region))
            stays = [far[stay] for stay in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if stay.size]
            if any(float((np.maximum.accumulate(stay) - stay).max()) > self.back for stay in stays):
                against.append((body, "goes the other way"))
            elif any(float(np.ptp(stay)) >= self.most * extent for stay in stays):
                passed.append((body, "passes"))
        return Observation(
            not against and matches(self.number, len(passed), "count"),
            expected,
            f"{len(passed)}; " + summary([*against, *passed]),
            f"{against[0][0].entry}.goal" if against else None,
            marks=[Mark(points=[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], text="one way")],
        )


@register("timetable")
class Timetable(OfBodies, EpisodePredicate):
    """The bodies of a selection cross a line at given times, each of them once."""

    start: tuple[Quantity, Quantity]
    """One end of the line [m]."""
    end: tuple[Quantity, Quantity]
    """The other end [m]."""
    times: list[Quantity]
    """When the first, the second, … of them crosses it [s]."""
    tol: Quantity = 0.5
    """Greatest deviation from these times [s]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look for the crossings."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"{self.of} cross the line {show(list(self.start))} to {show(list(self.end))} after "
        expected += ", ".join(f"{time:g} s" for time in self.times)
        crossings = sorted(
            ((time, body) for body in bodies for time in self._crossings(episode, body.index)),
            key=lambda crossing: crossing[0],
        )
        passed = len(crossings) == len(self.times) == len({body.name for _, body in crossings})
        passed = passed and all(abs(a - b) <= self.tol + 1e-9 for (a, _), b in zip(crossings, self.times, strict=True))
        return Observation(
            passed,
            expected,
            summary([(body, f"{time:.1f} s") for time, body in crossings]) or f"none of {len(bodies)}",
            f"{bodies[0].entry}.state" if bodies else None,
            marks=[Mark(points=[list(self.start), list(self.end)], text="line")],
        )

    def _crossings(self, episode: GradedEpisode, index: int) -> list[float]:
        length = math.dist(self.start, self.end) or 1.0
        unit = (np.array(self.end) - self.start) / length
        offset = episode.positions(index) - np.array(self.start)
        aside, along = unit[0] * offset[:, 1] - unit[1] * offset[:, 0], offset @ unit
        rows = np.flatnonzero((aside[1:] > 0) != (aside[:-1] > 0))
        return [float(episode.trace.time[row + 1]) for row in rows if 0 <= along[row] <= length]


@register("crosses")
class Crosses(OfBodies, EpisodePredicate):
    """Bodies of a selection cross the line of another body's way from one side to the other."""

    way_of: Selection
    """Selection of one body, whose way leads from its start to its goal."""
    number: Match
    """Accepted numbers of bodies that cross."""
    ahead: bool = True
    """Only crossings between the body and its goal count."""
    driving: bool = False
    """Only crossings count after the body has left its start."""
    direction: Literal["right_to_left", "left_to_right"] | None = None
    """Only those count that cross so, seen by the body."""
    spread: Quantity = 0.0
    """Least time between the first and the last crossing [s]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look for changes of side."""
        bodies, ways = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.way_of)
        expected = f"{self.of} that cross ahead of {self.way_of}: {self.number.words()}"
        if self.spread:
            expected += f", over at least {self.spread:g} s"
        if not bodies or len(ways) != 1 or ways[0].goal is None:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.way_of}: {len(ways)}")
        start, goal = np.array(ways[0].pose[:2]), np.array(ways[0].goal[:2])
        length = math.dist(start, goal) or 1.0
        unit = (goal - start) / length
        own = (episode.positions(ways[0].index) - start) @ unit
        times = []
        for body in bodies:
            offset = episode.positions(body.index) - start
            left, far = unit[0] * offset[:, 1] - unit[1] * offset[:, 0], offset @ unit
            for row in np.flatnonzero((left[1:] > 0) != (left[:-1] > 0)).tolist():
                way = "right_to_left" if left[row + 1] > 0 else "left_to_right"
                ahead = own[row] < far[row] <= length and (own[row] > _LEFT or not self.driving)
                if (ahead or not self.ahead) and self.direction in (None, way):
                    times.append(float(episode.trace.time[row]))
                    break
        spread = max(times) - min(times) if times else 0.0
        passed = matches(self.number, len(times), "count") and spread >= self.spread - 1e-9
        seen = ", ".join(f"{time:.1f} s" for time in sorted(times))
        return Observation(passed, expected, f"{len(times)}: {seen}", f"{bodies[0].entry}.state")
