"""The ways from starts to goals: how straight ones lie, what they pass, and whether there is a free one."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Literal

import shapely

from irsim.common.angles import wrap
from irsim_evals.grader.matching import Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, OfBodies, ScenePredicate, judged, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import Scene


@register("ways")
class Ways(OfBodies, ScenePredicate):
    """The straight lines from start to last goal of any two bodies of a selection, of which there must be two."""

    stage = "relations"

    angle: Match | None = None
    """Accepted angles between the directions of two ways [rad]: 0 for the same direction, π for opposite ones."""
    distance: Match | None = None
    """Accepted values of the smallest distance between two ways [m]; 0 where they cross."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Compare all pairs."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
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
            angle, distance = abs(wrap(_direction(a) - _direction(b))), float(shapely.distance(_line(a), _line(b)))
            seen = f"{a.name} and {b.name}: {math.degrees(angle):.0f}°, {show(distance)} m apart"
            off = self.angle is not None and not matches(self.angle, angle, "angle")
            far = self.distance is not None and not matches(self.distance, distance, "length")
            if off or far:
                marks = [Mark(points=[list(p) for p in _line(body).coords], text=body.name) for body in (a, b)]
                return Observation(False, expected, seen, f"{b.entry}.goal", marks=marks)
        return Observation(True, expected, seen)


def _direction(body: Body) -> float:
    goal = body.goal or [*body.pose]
    return math.atan2(goal[1] - body.pose[1], goal[0] - body.pose[0])


def _line(body: Body) -> shapely.LineString:
    return shapely.LineString([body.pose[:2], (body.goal or [*body.pose])[:2]])


@register("line_of_sight")
class LineOfSight(OfBodies, ScenePredicate):
    """Whether the straight line from each start to the goal is free. An empty selection fails."""

    stage = "relations"

    clear: bool
    """Whether the line is free of everything solid, or not."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Draw the lines."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        expected = f"from each of {self.of} to its goal the view is {'clear' if self.clear else 'blocked'}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        lines = {body.name: shapely.LineString([body.pose[:2], (body.goal or [])[:2]]) for body in bodies}
        clear = [(body, not shapely.intersects(scene.solid, lines[body.name])) for body in bodies]
        wrong = [(body, value) for body, value in clear if value != self.clear]
        marks = [Mark(points=[list(p) for p in lines[body.name].coords], text=body.name) for body, _ in wrong]
        return judged(expected, wrong, summary(clear), "goal", said="clear for ", marks=marks)


@register("line_passes")
class LinePasses(OfBodies, ScenePredicate):
    """The straight line from start to goal of every body of a selection comes near the middle of another selection."""

    stage = "relations"

    by: str
    """Name of the other selection: its middle is the mean of its positions."""
    distance: Match
    """Accepted distances of the line from that middle [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Measure."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goal is not None]
        places = [other.position for other in material.bodies(scene, self.by)]
        expected = f"the way of {self.of} passes the middle of {self.by} at {self.distance.words()} m"
        if not bodies or not places:
            return Observation(False, expected, f"{self.of}: {len(bodies)}, {self.by}: {len(places)}")
        middle = shapely.Point(sum(x for x, _ in places) / len(places), sum(y for _, y in places) / len(places))
        distances = [
            (body, float(shapely.LineString([body.pose[:2], (body.goal or [])[:2]]).distance(middle)))
            for body in bodies
        ]
        wrong = [(body, value) for body, value in distances if not matches(self.distance, value, "length")]
        return judged(expected, wrong, summary(distances), "goal")


@register("reachable")
class Reachable(OfBodies, ScenePredicate):
    """Every body of a selection can get from its start to each of its goals, on a grid of inflated obstacles."""

    stage = "relations"

    size: Literal["inner", "outer"] = "inner"
    """Disc that stands for the body: the largest one inside of it, or the smallest one round it."""
    possible: bool = True
    """Whether there must be a path, or must not."""
    to: tuple[Quantity, Quantity] | None = None
    """A place instead of the goals [m]."""
    plug: tuple[Quantity, Quantity, Quantity] | None = None
    """x, y, radius of a disc that closes a gap first [m]."""

    def observe(self, material: Material, scene: Scene) -> Observation:
        """Search for paths."""
        bodies = [body for body in material.bodies(scene, self.of) if body.goals or self.to is not None]
        closed = "" if self.plug is None else f" with the gap at ({self.plug[0]:g}, {self.plug[1]:g}) closed"
        target = "its goal" if self.to is None else f"({self.to[0]:g}, {self.to[1]:g})"
        expected = f"each of {self.of} {'can' if self.possible else 'cannot'} get to {target}{closed}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body with a goal")
        plugs = () if self.plug is None else (self.plug,)
        results = [(body, self._gets_there(scene, body, plugs)) for body in bodies]
        wrong = [(body, value) for body, value in results if value != self.possible]
        marks = [Mark(points=[list(place)], text=body.name) for body, _ in wrong for place in self._targets(body)]
        return judged(expected, wrong, summary(results), "goal", said="a path for ", marks=marks)

    def _gets_there(self, scene: Scene, body: Body, plugs: tuple[tuple[float, float, float], ...]) -> bool:
        radius = disc_radius(body, self.size)
        places = [(body.pose[0], body.pose[1]), *self._targets(body)]
        return all(scene.is_reachable(a, b, radius, plugs) for a, b in itertools.pairwise(places))

    def _targets(self, body: Body) -> list[tuple[float, float]]:
        return [(goal[0], goal[1]) for goal in body.goals] if self.to is None else [self.to]


def disc_radius(body: Body, size: Literal["inner", "outer"] = "inner") -> float:
    """Radius of the disc that stands for a body [m]."""
    if body.radius is not None:
        return body.radius
    if size == "outer":
        return float(shapely.minimum_bounding_radius(body.footprint))
    circle = shapely.maximum_inscribed_circle(body.footprint)
    return float(circle.length)
