"""Corridors, doorways, dead ends and rooms, measured by straight looks through the world."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import shapely
import shapely.affinity

from irsim_evals.grader.matching import Counted, Kind, Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import Observation, OfBodies, ScenePredicate, measured, register, travellers

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

__all__ = ["Point", "along", "free_length", "free_parts"]

Point = tuple[float, float]
_SLIVER = 1e-6
"""Free parts shorter than this [m] come from rounding."""
_FAR = 1e3
"""Distance [m] at which a wall is no longer looked for."""
_LENGTH_STEP = 0.05
"""Distance [m] between the sections that measure how long the walls are."""
_DEPTH_STEP = 0.02
"""Distance [m] between the sections that measure the depth."""
_BEFORE = 0.1
"""Distance [m] of the first section from the back of the pocket."""
_RAYS = 91
"""Directions in which gaps between the walls are looked for."""
_ROOM: dict[str, Kind] = {"long_side": "length", "short_side": "length", "area": "length"}
"""Measures of a room."""
_FINE = 0.01
"""Distance [m] between the sections of a room; ten times the thickness that a line has as its wall."""


def along(start: Point, direction: float, distance: float) -> Point:
    """The point at a distance [m] in a direction [rad]."""
    return start[0] + math.cos(direction) * distance, start[1] + math.sin(direction) * distance


def free_length(solid: Any, start: Point, direction: float, most: float) -> float:
    """Distance [m] from a point to the first solid thing in a direction, at most ``most``; 0 inside of one."""
    hit = shapely.intersection(solid, shapely.LineString([start, along(start, direction, most)]))
    return most if hit.is_empty else float(shapely.distance(shapely.Point(start), hit))


def free_parts(solid: Any, start: Point, end: Point, depth: float) -> list[tuple[float, float]]:
    """The parts of a line that nothing solid crosses.

    Args:
        solid: Geometry of everything solid.
        start, end: Ends of the line.
        depth: Whatever lies at most this far beside the line counts as on it [m], so that the two jambs of a door
            need not be exactly in line.

    Returns:
        Begin and end of each free part, as distances from ``start`` [m].
    """
    length = math.dist(start, end)
    heading = math.atan2(end[1] - start[1], end[0] - start[0])
    line = shapely.LineString([start, end])
    near = shapely.intersection(solid, line.buffer(max(depth, 1e-9), cap_style="flat"))
    turned = shapely.affinity.rotate(near, -heading, origin=start, use_radians=True)
    covered = sorted(
        (part.bounds[0] - start[0], part.bounds[2] - start[0])
        for part in getattr(turned, "geoms", [turned])
        if not part.is_empty
    )
    free, at = [], 0.0
    for low, high in covered:
        if low - at > _SLIVER:
            free.append((at, low))
        at = max(at, high)
    if length - at > _SLIVER:
        free.append((at, length))
    return free


def _width(scene: GradedScene, at: Point, heading: float) -> float:
    """Free width [m] across a direction at a place, as if it were far where one side has no wall."""
    sides = [free_length(scene.solid, at, heading + turn, _FAR) for turn in (math.pi / 2, -math.pi / 2)]
    return _FAR if max(sides) >= _FAR else sum(sides)


@register("corridor", "relations")
class Corridor(OfBodies, ScenePredicate):
    """Each body of a selection goes along a corridor: solid on both sides of the line from its start to its goal."""

    width: Match
    """Accepted free widths [m], measured across the line at each section."""
    sections: Counted = 12
    """Least number of sections, evenly spaced from start to goal; with more than one no gap of a wall is missed."""
    direction: Quantity | None = None
    """Direction of the corridor [rad], if not that from start to goal."""
    length: Match | None = None
    """Accepted lengths of the walls on both sides [m], as far as the width holds."""
    start_within: Quantity | None = None
    """Greatest share of the corridor's length that lies before the start and behind the goal."""
    outside: Quantity = 0.0
    """Greatest distance of the start before the corridor, and of the goal behind it [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure the sections."""
        bodies = travellers(self, material, scene)
        expected = f"a corridor {self.width.words()} m wide"
        expected += f", {self.length.words()} m long" if self.length is not None else ""
        for body in bodies:
            start, goal = _ends(body)
            way = math.dist(start, goal)
            heading = math.atan2(goal[1] - start[1], goal[0] - start[0]) if self.direction is None else self.direction
            before, behind = self._out(scene, start, heading, way), self._out(scene, goal, heading + math.pi, way)
            start, goal = along(start, heading, before), along(goal, heading, -behind)
            way -= before + behind
            sections = self.sections if self.sections == 1 else max(self.sections, math.ceil(way / _LENGTH_STEP) + 1)
            for k in range(sections):
                at = along(start, heading, way * k / max(1, sections - 1))
                width = _width(scene, at, heading)
                if not matches(self.width, width, "length"):
                    seen = f"{show(width)} m" if width < _FAR else "no wall on one side"
                    marks = [Mark(points=[list(at)], text=seen)]
                    return Observation(False, expected, f"at ({at[0]:.2f}, {at[1]:.2f}): {seen}", marks=marks)
            if self.length is None:
                continue
            back, front = (self._reach(scene, p, h) for p, h in ((start, heading + math.pi), (goal, heading)))
            total = back + way + front
            if not matches(self.length, total, "length"):
                return Observation(False, expected, f"walls on both sides for {show(total)} m")
            if self.start_within is not None and max(back, front) > self.start_within * total + 1e-6:
                return Observation(False, expected, f"{show(max(back, front))} m of it lie before or behind the way")
        return Observation(True, expected, "so it is")

    def _out(self, scene: GradedScene, place: Point, heading: float, way: float) -> float:
        """How far it is from a place to the corridor [m]; 0 if it is farther than allowed."""
        far = np.arange(0, min(self.outside, way / 2) + 1e-9, _LENGTH_STEP).tolist()
        return next((d for d in far if _width(scene, along(place, heading, d), heading) < _FAR), 0.0)

    def _reach(self, scene: GradedScene, start: Point, heading: float) -> float:
        """How far the walls go on from a place [m]."""
        x0, y0, x1, y1 = scene.bounds
        far: list[float] = np.arange(0, math.hypot(x1 - x0, y1 - y0), _LENGTH_STEP).tolist()
        widths = ((d, _width(scene, along(start, heading, d), heading)) for d in far)
        return next((max(0.0, d - _LENGTH_STEP) for d, w in widths if not matches(self.width, w, "length")), far[-1])


def _ends(body: GradedBody) -> tuple[Point, Point]:
    goal = body.goal or body.pose
    return (body.pose[0], body.pose[1]), (goal[0], goal[1])


@register("doorway", "relations")
class Doorway(ScenePredicate):
    """A line of the world is solid but for some openings."""

    start: tuple[Quantity, Quantity]
    """One end of the line [m]."""
    end: tuple[Quantity, Quantity]
    """The other end [m]."""
    depth: Quantity = 0.2
    """Solid things at most this far beside the line count as on it [m]."""
    openings: Match = Match(eq=1)
    """Accepted numbers of openings."""
    width: Match | None = None
    """Accepted widths of each opening [m]."""
    middles: list[tuple[Quantity, Quantity]] = []
    """Middle of each opening in order from ``start`` [m]."""
    tol: Quantity = 0.2
    """Greatest distance of an opening's middle from the wanted one [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Look for openings."""
        parts = free_parts(scene.solid, self.start, self.end, self.depth)
        heading = math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])
        spots = [along(self.start, heading, (a + b) / 2) for a, b in parts]
        widths = [b - a for a, b in parts]
        expected = f"openings from {show(list(self.start))} to {show(list(self.end))}: {self.openings.words()}"
        if self.width is not None:
            expected += f", {self.width.words()} m wide"
        observed = ", ".join(f"{w:.2f} m at ({x:.2f}, {y:.2f})" for w, (x, y) in zip(widths, spots, strict=True))
        passed = matches(self.openings, len(parts), "count")
        if self.width is not None:
            passed = passed and all(matches(self.width, width, "length") for width in widths)
        if self.middles:
            expected += f", in the middle {show([list(p) for p in self.middles])}"
            passed = passed and len(self.middles) == len(spots)
            passed = passed and all(math.dist(a, b) <= self.tol for a, b in zip(spots, self.middles, strict=True))
        marks = [] if passed else [Mark(points=[list(self.start), list(self.end)], text=observed or "solid")]
        return Observation(passed, expected, observed or "no opening", marks=marks)


@register("pocket", "relations")
class Pocket(OfBodies, ScenePredicate):
    """The straight line from start to goal leads into a pocket and hits its back."""

    width: Match
    """Accepted free widths inside [m]."""
    depth: Match
    """Accepted depths from the opening to the back [m]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Go in and measure."""
        bodies = travellers(self, material, scene)
        expected = f"a pocket {self.width.words()} m wide and {self.depth.words()} m deep on the way"
        for body in bodies:
            start, goal = _ends(body)
            way, heading = math.dist(start, goal), math.atan2(goal[1] - start[1], goal[0] - start[0])
            back = free_length(scene.solid, start, heading, way)
            if back >= way:
                return Observation(False, expected, f"nothing solid between {body.name} and its goal")
            widths, depth = self._go_out(scene, start, heading, back)
            if not widths:
                marks = [Mark(points=[list(along(start, heading, back))], text="no pocket")]
                return Observation(False, expected, "no walls on both sides before what is hit", marks=marks)
            width = sorted(widths)[len(widths) // 2]
            if not (matches(self.width, width, "length") and matches(self.depth, depth, "length")):
                return Observation(False, expected, f"{show(width)} m wide, {show(depth)} m deep")
            gap = _gap(scene, along(start, heading, back - depth / 2), heading, math.hypot(width, depth))
            if gap is not None:
                marks = [Mark(points=[list(gap)], text="gap")]
                return Observation(False, expected, "its walls leave a gap", marks=marks)
        return Observation(True, expected, "so it is")

    def _go_out(self, scene: GradedScene, start: Point, heading: float, back: float) -> tuple[list[float], float]:
        """Free widths from the back to the opening, and the depth [m]."""
        widths: list[float] = []
        depth = _BEFORE
        while depth < back:
            width = _width(scene, along(start, heading, back - depth), heading)
            if width >= _FAR or (widths and width > 1.5 * widths[0]):
                break
            widths.append(width)
            depth += _DEPTH_STEP
        return widths, depth - _DEPTH_STEP / 2


def _gap(scene: GradedScene, inside: Point, heading: float, far: float) -> Point | None:
    """A place where one sees out of the pocket from its inside other than through its opening; None without one."""
    for k in range(_RAYS):
        direction = heading + math.pi * (k / (_RAYS - 1) - 0.5)
        if free_length(scene.solid, inside, direction, far) >= far:
            return along(inside, direction, far)
    return None


@register("room", "relations")
class Room(OfBodies, ScenePredicate):
    """The room in which every body of a selection stands: what a disc as wide as `doors` covers on its ways from there,
    with the right angles that it leaves. Who stands in a door is in no room and fails, as an empty selection does."""

    doors: Quantity
    """Openings narrower than this are closed [m]."""
    what: Literal["position", "goal"] = "position"
    """The place that the room is round: where the body starts, or its last goal."""
    long_side: Match | None = None
    """Accepted lengths of the room [m], along the longer side of the smallest rectangle round it, as far as the room is
    as wide as `doors` there; what stands in its middle makes it no shorter."""
    short_side: Match | None = None
    """Accepted widths, measured in the same way across that [m]."""
    area: Match | None = None
    """Accepted free areas between these sides [m²]."""

    def observe(self, material: Material, scene: GradedScene) -> Observation:
        """Measure each room."""
        bodies = travellers(self, material, scene) if self.what == "goal" else self.bodies(material, scene)
        of, key = f"the room round the {self.what} of {self.of}", "goal" if self.what == "goal" else "state"
        return measured(self, of, bodies, _ROOM, partial(self._measures, scene), key)

    def _measures(self, scene: GradedScene, body: GradedBody) -> dict[str, float | None]:
        free = shapely.difference(shapely.box(*scene.bounds), scene.solid.buffer(_FINE / 20, cap_style="flat"))
        parts = shapely.get_parts(shapely.buffer(free, -self.doors / 2))
        rooms = shapely.buffer(parts, self.doors / 2, join_style="mitre", mitre_limit=1.42)  # fills right angles
        place = shapely.Point(body.position if self.what == "position" or body.goal is None else body.goal[:2])
        around = shapely.intersection(rooms[shapely.covers(rooms, place)], free)
        if len(around) != 1:
            return dict.fromkeys(_ROOM)
        (x0, y0), (x1, y1) = shapely.get_coordinates(shapely.oriented_envelope(around[0]))[:2]
        turned = shapely.affinity.rotate(around[0], -math.atan2(y1 - y0, x1 - x0), (0, 0), use_radians=True)
        (left, right), (low, high) = (self._span(room) for room in (turned, shapely.transform(turned, np.fliplr)))
        short, long = sorted((right - left, high - low))
        area = shapely.intersection(turned, shapely.box(left, low, right, high)).area
        return {"long_side": long, "short_side": short, "area": float(area)}

    def _span(self, room: Any) -> tuple[float, float]:
        """The first and the last place along x at which the section across a room is wide enough."""
        x0, y0, x1, y1 = room.bounds
        at = np.linspace(x0, x1, math.ceil((x1 - x0) / _FINE) + 1)
        cut = shapely.intersection(shapely.linestrings([[[x, y0], [x, y1]] for x in at.tolist()]), room)
        parts, section = shapely.get_parts(cut, return_index=True)
        wide = at[section[shapely.length(parts) >= self.doors]]
        return float(wide.min()), float(wide.max())
