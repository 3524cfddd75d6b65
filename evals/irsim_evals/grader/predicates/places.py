"""Where bodies and their goals are, and where bodies look."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Literal

import shapely
from pydantic import model_validator

from irsim.common.angles import wrap
from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import (
    Observation,
    OfBodies,
    ScenePredicate,
    judged,
    middle,
    register,
    summary,
    travellers,
)  # fmt: skip
from irsim_evals.grader.predicates.ways import way_of
from irsim_evals.grader.selection import BUILT_IN, Selection
from irsim_evals.grader.words import OneOf

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

_DIRECTIONS = {"east": 0.0, "north": math.pi / 2, "west": math.pi, "south": -math.pi / 2}
Toward = Annotated[str, OneOf("direction or selection", ("goal", *_DIRECTIONS, *BUILT_IN), own="selections")]


@register("inside", "relations")
class Inside(OfBodies, ScenePredicate):
    """Every body of a selection lies in a region. An empty selection fails."""

    what: Literal["position", "footprint", "goal"] = "position"
    """The part that lies in the region: its position, its whole footprint, or each of its goals."""
    region: tuple[Quantity, Quantity, Quantity, Quantity] | None = None
    """x0, y0, x1, y1 [m]; default: the world."""
    shares: tuple[Quantity, Quantity, Quantity, Quantity] | None = None
    """The same as shares of the world's extent: ``[0, 0, 0.33, 0.33]`` is its lower left third."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Look at each of them."""
        bodies = material.bodies(scene, self.of)
        x0, y0, x1, y1 = self._box(scene)
        expected = f"{self.what} of {self.of} within x {show(x0)} to {show(x1)}, y {show(y0)} to {show(y1)}"
        points = [(body, point) for body in bodies for point in self._points(body)]
        wrong = [(body, point) for body, point in points if not _holds((x0, y0, x1, y1), point)]
        missing = [body for body in bodies if not self._points(body)]
        if missing:
            return Observation(False, expected, f"{missing[0].name}: no goal")
        key = "goal" if self.what == "goal" else "state"
        marks = [Mark(points=[list(point)], text=body.name) for body, point in wrong]
        return judged(expected, points, wrong, key, right=f"all {len(bodies)}", marks=marks)

    def _box(self, scene: GradedScene) -> tuple[float, float, float, float]:
        if self.region is not None:
            return self.region
        x0, y0, x1, y1 = scene.bounds
        a, b, c, d = self.shares or (0.0, 0.0, 1.0, 1.0)
        return x0 + a * (x1 - x0), y0 + b * (y1 - y0), x0 + c * (x1 - x0), y0 + d * (y1 - y0)

    def _points(self, body: GradedBody) -> list[tuple[float, float]]:
        if self.what == "goal":
            return [(goal[0], goal[1]) for goal in body.goals]
        if self.what == "footprint":
            return [(float(x), float(y)) for x, y in shapely.get_coordinates(body.footprint)]
        return [body.position]


def _holds(box: tuple[float, float, float, float], point: tuple[float, float]) -> bool:
    return box[0] - 1e-6 <= point[0] <= box[2] + 1e-6 and box[1] - 1e-6 <= point[1] <= box[3] + 1e-6


@register("near", "relations")
class Near(OfBodies, ScenePredicate):
    """Every body of a selection is at some distance from the bodies of another, or from a place."""

    to: Selection | None = None
    """Name of the other selection."""
    place: tuple[Quantity, Quantity] | None = None
    """A place instead of a selection [m]."""
    what: Literal["position", "footprint", "goal", "way"] = "position"
    """The part of the first selection that counts; the way is the straight line from the start to the last goal.
    Footprints are measured to footprints, edge to edge."""
    edge: bool | None = None
    """Whether to measure to the edge of the others instead of to their position; default: from footprints only."""
    distance: Match
    """Accepted distances [m]."""
    which: Literal["nearest", "farthest", "middle"] = "nearest"
    """The body of the other selection to which it is measured, or the mean of all their positions."""

    @model_validator(mode="after")
    def _one(self) -> Near:
        if (self.to is None) == (self.place is None):
            raise ValueError("give either `to` or `place`")
        return self

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure."""
        bodies = material.bodies(scene, self.of)
        others = [] if self.to is None else material.bodies(scene, self.to)
        target = f"the {self.which} of {self.to}" if self.place is None else show(list(self.place))
        expected = f"{self.what} of {self.of} to {target}: {self.distance.words()} m"
        if self.place is None and not others:
            return Observation(False, expected, "no body")
        distances = [(body, self._measure(body, others)) for body in bodies]
        wrong = [(body, value) for body, value in distances if not matches(self.distance, value, "length")]
        marks = [Mark(points=[list(body.position)], text=body.name) for body, _ in wrong]
        return judged(expected, distances, wrong, "goal" if self.what in ("goal", "way") else "state", marks=marks)

    def _measure(self, body: GradedBody, others: list[GradedBody]) -> float | None:
        if self.what in ("goal", "way") and body.goal is None:
            return None
        at = {
            "position": shapely.Point(body.position),
            "footprint": body.footprint,
            "goal": shapely.Point((body.goal or body.position)[:2]),
            "way": way_of(body),
        }[self.what]
        edge = self.what == "footprint" if self.edge is None else self.edge
        rest = [other for other in others if other is not body]
        shapes = [other.footprint if edge else shapely.Point(other.position) for other in rest]
        if self.which == "middle" and rest:
            shapes = [shapely.Point(middle(rest))]
        if self.place is not None:
            shapes = [shapely.Point(self.place)]
        if not shapes:
            return None
        distances = [float(shapely.distance(at, shape)) for shape in shapes]
        return max(distances) if self.which == "farthest" else min(distances)


@register("spacing", "relations")
class Spacing(OfBodies, ScenePredicate):
    """The smallest distance between any two bodies of a selection, of which there must be two."""

    what: Literal["position", "footprint", "goal"] = "position"
    """Ends of the distances: between positions, between the edges of footprints, or between last goals."""
    distance: Match
    """Accepted values of the smallest distance [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure all pairs."""
        bodies = travellers(self, material, scene) if self.what == "goal" else material.bodies(scene, self.of)
        expected = f"{self.what} of {self.of} apart: {self.distance.words()} m"
        pairs = [(self._apart(a, b), a, b) for a, b in itertools.combinations(bodies, 2)]
        if not pairs:
            return Observation(False, expected, f"{len(bodies)} bodies")
        least, a, b = min(pairs, key=lambda pair: pair[0])
        passed = matches(self.distance, least, "length")
        marks = [] if passed else [Mark(points=[list(a.position), list(b.position)], text=f"{least:.2f} m")]
        return Observation(passed, expected, f"{a.name} and {b.name}: {show(least)} m", f"{b.entry}.state", marks=marks)

    def _apart(self, a: GradedBody, b: GradedBody) -> float:
        if self.what == "footprint":
            return float(shapely.distance(a.footprint, b.footprint))
        if self.what == "goal" and a.goal is not None and b.goal is not None:
            return math.dist(a.goal[:2], b.goal[:2])
        return math.dist(a.position, b.position)


@register("beside", "relations")
class Beside(OfBodies, ScenePredicate):
    """Every body of a selection starts, or has its goal, on one side of another body's way."""

    way_of: Selection
    """Selection of one body, whose way leads from its start to its goal."""
    what: Literal["start", "goal"] = "start"
    """The place that lies there."""
    side: Literal["left", "right", "ahead", "behind"]
    """Seen from the start of the way toward its goal."""
    by: Quantity = 0.0
    """Least distance from the line [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure the distances."""
        bodies, ways = material.bodies(scene, self.of), material.bodies(scene, self.way_of)
        expected = f"{self.what} of {self.of} {self.side} of the way of {self.way_of}"
        if not bodies or len(ways) != 1 or ways[0].goal is None:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.way_of}: {len(ways)}")
        (x, y, _), goal = ways[0].pose, ways[0].goal
        length = math.dist((x, y), goal[:2]) or 1.0
        dx, dy = (goal[0] - x) / length, (goal[1] - y) / length
        distances = []
        for body in bodies:
            point = body.position if self.what == "start" else body.goal
            if point is None:
                distances.append((body, -math.inf))
                continue
            px, py = point[0] - x, point[1] - y
            ahead, left = px * dx + py * dy, dx * py - dy * px
            distances.append((body, {"left": left, "right": -left, "ahead": ahead, "behind": -ahead}[self.side]))
        wrong = [(body, value) for body, value in distances if value < self.by - 1e-9 or value <= 0]
        return judged(expected, distances, wrong, "state" if self.what == "start" else "goal")


@register("on_circle", "relations")
class OnCircle(OfBodies, ScenePredicate):
    """Every body of a selection stands on a circle."""

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

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure radii, angles and goals."""
        bodies = material.bodies(scene, self.of)
        expected = f"{self.of} on a circle of radius {show(self.radius)} m"
        if len(bodies) < 2:
            return Observation(False, expected, f"{len(bodies)} bodies")
        places = [body.position for body in bodies]
        cx, cy = self.center or middle(bodies)
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
                off = _apart(math.atan2(cy - place[1], cx - place[0]), body.pose[2])
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


@register("facing", "relations")
class Facing(OfBodies, ScenePredicate):
    """Every body of a selection looks somewhere. An empty selection fails."""

    toward: Toward | tuple[Quantity, Quantity]
    """``goal``, ``north``, ``east``, ``south``, ``west``, a place [m], or the name of a selection: its middle."""
    tol: Quantity = math.radians(20)
    """Greatest deviation [rad]."""
    away: bool = False
    """It looks the other way."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure the angles."""
        bodies = self.bodies(material, scene)
        where = self.toward if isinstance(self.toward, str) else show(list(self.toward))
        expected = f"{self.of} {'away from' if self.away else 'toward'} {where}"
        angles = [(body, self._off(material, scene, body)) for body in bodies]
        wrong = [(body, off) for body, off in angles if off is None or off > self.tol + 1e-9]
        degrees = [(body, None if off is None else f"{math.degrees(off):.0f}° off") for body, off in wrong or angles]
        return Observation(not wrong, expected, summary(degrees), f"{wrong[0][0].entry}.state" if wrong else None)

    def _off(self, material: Material, scene: GradedScene, body: GradedBody) -> float | None:
        if self.toward == "goal":
            target = None if body.goal is None else (body.goal[0], body.goal[1])
        elif isinstance(self.toward, str) and self.toward in _DIRECTIONS:
            return _apart(_DIRECTIONS[self.toward] + (math.pi if self.away else 0.0), body.pose[2])
        elif isinstance(self.toward, str):
            others = [other for other in material.bodies(scene, self.toward) if other is not body]
            target = middle(others) if others else None
        else:
            target = self.toward
        if target is None:
            return None
        wanted = math.atan2(target[1] - body.pose[1], target[0] - body.pose[0]) + (math.pi if self.away else 0.0)
        return _apart(wanted, body.pose[2])


def _apart(a: float, b: float) -> float:
    return float(abs(wrap(a - b)))
