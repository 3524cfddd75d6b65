"""Encounters of bodies in an episode: collisions, distances, who passes whom, and who sees what."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
import shapely

from irsim.options.registry import SENSORS
from irsim_evals.grader.episode import dense
from irsim_evals.grader.matching import Kind, Match, Quantity, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import (
    EpisodePredicate,
    Observation,
    OfBodies,
    judged,
    measured,
    register,
    summary,
)
from irsim_evals.grader.selection import Selection
from irsim_evals.grader.words import OneOf

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode, Look
    from irsim_evals.grader.material import Material

_SLIDE = 0.02
"""Distance [m] that two bodies move relative to each other between two looks at how near they are."""
_STRIDE = np.array([-0.1, 0.1])
"""The part of a path before and behind a place that tells the direction of motion there [m]."""
_ROWS = 500
"""Rows of poses whose hulls are made at once."""

_SIGHT: dict[str, Kind] = {"number": "count", "beams": "count", "first": "time", "seconds": "time"}
"""Measures of what is seen."""


@register("collisions")
class Collisions(OfBodies, EpisodePredicate):
    """How many bodies of a selection collide with something. An empty selection fails."""

    number: Match = Match(eq=0)
    """Accepted numbers of bodies that collide."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Count them."""
        bodies = self.bodies(material, episode.scene)
        expected = f"{self.of} that collide: {self.number.words()}"
        hits = [(body, episode.collisions(body.name)) for body in bodies]
        bad = [(body, contacts[0]) for body, contacts in hits if contacts]
        events = [event for event in episode.events if event.kind == "collision"]
        seen = f"{len(bad)}; " + summary([(body, f"{partner} at {time:.1f} s") for body, (time, partner) in bad])
        where = f"{bad[0][0].entry}.behavior" if bad else None
        marks = [Mark(points=[[event.x, event.y]], text=f"{event.time:.1f} s") for event in events[:5]]
        return Observation(matches(self.number, len(bad), "count"), expected, seen, where, marks=marks)


@register("separation")
class Separation(EpisodePredicate):
    """The smallest distance between the bodies of two selections, edge to edge, at any time of the episode."""

    of: Selection
    """Name of the first selection."""
    to: Selection
    """Name of the second selection."""
    distance: Match
    """Accepted values of the smallest distance [m]."""
    hull: bool = False
    """Measure to the convex hull of the footprints of the whole second selection, as it stands at the time, instead of
    to each of its bodies: 0 for who goes in between them."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Measure at every step."""
        first, second = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.to)
        expected = f"smallest distance of {self.of} to {'the hull of ' * self.hull}{self.to}: {self.distance.words()} m"
        others = [(a, [b for b in second if b is not a]) for a in first]
        pairs = [(a, group) for a, rest in others for group in ([rest] if self.hull else [[b] for b in rest]) if group]
        if not pairs:
            return Observation(False, expected, "no pair of bodies")
        distances = ((to_hull if self.hull else closest)(episode, *pair) for pair in pairs)
        least, (a, group) = min(zip(distances, pairs, strict=True), key=lambda entry: entry[0])
        seen = f"{a.name} and {', '.join(b.name for b in group)}: {show(least)} m"
        return Observation(matches(self.distance, least, "length"), expected, seen, a.entry)


@register("passes")
class Passes(OfBodies, EpisodePredicate):
    """On which side of its way every body of a selection passes each body of another one: the side of its direction of
    motion (over 20 cm of its path) on which the nearest point of the other, or the middle of one with a drive, lies
    where it comes closest. It does not pass, and fails, where that point lies more ahead of it or behind it than beside
    it. An empty selection fails."""

    by: Selection
    """Name of the selection of the bodies that are passed."""
    side: Literal["left", "right", "same", "alternating"]
    """``left``: each of them lies to the left of its way; ``same``: all on one side, whichever; ``alternating``: each
    next one along its path on the other side, as in a slalom, of which there must be two."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Look at each closest approach."""
        bodies, others = (material.bodies(episode.scene, name) for name in (self.of, self.by))
        seen, wrong = [], []
        for body in bodies:
            passed = sorted((*_passed(episode, body, other), other.name) for other in others if other is not body)
            sides = [side for _, side, _ in passed]
            seen.append((body, ", ".join(f"{name} {side or 'not passed'}" for _, side, name in passed)))
            turns = [a != b for a, b in itertools.pairwise(sides)]
            right = {"same": not any(turns), "alternating": bool(turns) and all(turns)}
            if not right.get(self.side, {*sides} == {self.side}) or not all(sides) or not sides:
                wrong.append(seen[-1])
        return judged(f"{self.of} pass {self.by}: {self.side}", seen, wrong, "behavior")


def _passed(episode: GradedEpisode, body: GradedBody, other: GradedBody) -> tuple[float, str]:
    """Where a body passes another, along its path from its end back [m], and the side; empty if it does not pass."""
    poses = _together(episode, [body, other])
    if not len(poses):
        return 0.0, ""
    way, there = poses[:, 0, :2], poses[:, 1, :2]
    if other.kinematics is None:
        there = shapely.get_coordinates(shapely.shortest_line(other.footprint, shapely.points(way)))[::2]
    offsets = there - way
    row = int(np.hypot(*offsets.T).argmin())
    far = np.append(0.0, np.hypot(*np.diff(way, axis=0).T).cumsum())
    (dx, dy), (x, y) = (np.diff(np.interp(far[row] + _STRIDE, far, column))[0] for column in way.T), offsets[row]
    ahead, left = float(dx * x + dy * y), float(dx * y - dy * x)
    return float(far[row] - far[-1]), ("left" if left > 0 else "right") if abs(left) > abs(ahead) else ""


def closest(episode: GradedEpisode, a: GradedBody, others: list[GradedBody]) -> float:
    """The smallest distance between the footprints of a body and another during an episode, within steps, too [m]."""
    (b,) = others
    first, second = _together(episode, [a, b]).transpose(1, 0, 2)
    if not len(first):
        return math.inf  # they never meet in the world
    centers = np.hypot(*(first[:, :2] - second[:, :2]).T)
    reach = sum(float(shapely.hausdorff_distance(shapely.Point(c.pose[:2]), c.footprint)) for c in (a, b))
    near = np.flatnonzero(centers <= centers.min() + (0.0 if a.radius and b.radius else reach))
    return min(edge_to_edge((a, first[row]), (b, second[row])) for row in near.tolist())


def to_hull(episode: GradedEpisode, body: GradedBody, group: list[GradedBody]) -> float:
    """The smallest distance of a body to the hull of a group during an episode, within steps, too [m]."""
    poses, least = _together(episode, [body, *group]), math.inf
    for part in np.array_split(poses, len(poses) // _ROWS + 1) if len(poses) else ():  # so that memory suffices
        shapes = np.stack([_placed(one, np.nan_to_num(part[:, k])) for k, one in enumerate([body, *group])], axis=1)
        shapes[np.isnan(part[..., 0])] = None
        hulls = shapely.convex_hull(shapely.geometrycollections(shapes[:, 1:]))
        least = min(least, float(shapely.distance(shapes[:, 0], hulls).min()))
    return least


def _together(episode: GradedEpisode, bodies: list[GradedBody]) -> Any:
    """(T, N, 3) poses of bodies while the first is in the world with any other, with rows between distant steps."""
    poses = episode.trace.pose[:, [body.index for body in bodies]]
    here = ~np.isnan(poses[:, :, 0])
    poses = poses[here[:, 0] & here[:, 1:].any(axis=1)]
    poses[:, :, 2] = np.unwrap(np.nan_to_num(poses[:, :, 2]), axis=0)
    steps = np.diff(poses[:, :1, :2] - poses[:, 1:, :2], axis=0)
    far = np.nan_to_num(np.hypot(steps[..., 0], steps[..., 1])).max(initial=0.0)
    return dense(poses.reshape(len(poses), -1), math.ceil(far / _SLIDE)).reshape(-1, len(bodies), 3)


def edge_to_edge(*placed: tuple[GradedBody, Any]) -> float:
    """Distance between the footprints of two bodies at their poses [m]; negative where two discs overlap."""
    (a, first), (b, second) = placed
    if a.radius is not None and b.radius is not None:
        return math.dist(first[:2], second[:2]) - a.radius - b.radius
    return float(shapely.distance(_placed(a, first[None]), _placed(b, second[None]))[0])


def _placed(body: GradedBody, poses: Any) -> Any:
    """(T,) the footprint of a body at (T, 3) poses."""
    x, y, heading = poses.T[..., None] - np.array([0.0, 0.0, body.pose[2]])[:, None, None]

    def put(corners: Any) -> Any:
        dx, dy = np.moveaxis(corners.reshape(len(poses), -1, 2) - body.pose[:2], 2, 0)
        cos, sin = np.cos(heading), np.sin(heading)
        return np.stack([x + cos * dx - sin * dy, y + sin * dx + cos * dy], axis=2).reshape(-1, 2)

    return shapely.transform(np.full(len(poses), body.footprint, dtype=object), put)


@register("sees")
class Sees(OfBodies, EpisodePredicate):
    """How many things every body of a selection sees with its sensors or its field of view, when and for how long. A
    thing is seen if a beam hits it or if it lies partly in the field of view. An empty selection fails."""

    at_start = True
    looks = True

    what: Selection | None = None
    """Name of the selection of what may be seen; default: everything, the map and the walls of the world included."""
    by: Annotated[str, OneOf("sensor", (*SENSORS.installed(), "fov"))] | None = None
    """Kind of the sensor, such as ``lidar2d``, or ``fov`` for the field of view; default: any."""
    since: Quantity = 0.0
    """Begin of the time in which it counts [s]; a negative time counts back from the end of the episode."""
    until: Quantity | None = None
    """End of the time in which it counts [s]; default: the end of the episode."""
    radial: Match | None = None
    """Accepted radial velocities, positive when receding [m/s]; only beams that measure one of them count."""
    number: Match | None = None
    """Accepted numbers of things that are seen in that time, each counted once."""
    beams: Match | None = None
    """Accepted numbers of beams that hit them at one moment, the greatest in that time."""
    first: Match | None = None
    """Accepted times at which the first of them is seen [s]; ``given: false`` if none ever is."""
    seconds: Match | None = None
    """Accepted durations for which at least one of them is seen, without the gaps between [s]."""

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Collect the looks of each body."""
        low, high = episode.moment(self.since), episode.duration if self.until is None else episode.moment(self.until)
        time = episode.trace.time
        rows = np.flatnonzero((time >= low - 1e-9) & (time <= high + 1e-9)).tolist()
        bodies, objects = material.bodies(episode.scene, self.of), self._objects(material, episode)
        asked = any(getattr(self, name) is not None for name in _SIGHT)
        said = self if asked else self.model_copy(update={"number": Match(ge=1)})
        of = f"{self.of} see {self.what or 'anything'}" + (f" with {self.by}" if self.by else "")
        of += f" from {low:g} to {high:g} s"
        if not rows or objects == set():
            return Observation(
                False, of, f"{self.what}: no body" if rows else f"the episode lasts {episode.duration:g} s"
            )
        return measured(said, of, bodies, _SIGHT, lambda body: self._sight(episode, body, rows, objects), "sensors")

    def _objects(self, material: Material, episode: GradedEpisode) -> set[int] | None:
        """Indices of what may be seen; None for everything."""
        return None if self.what is None else {body.index for body in material.bodies(episode.scene, self.what)}

    def _sight(
        self, episode: GradedEpisode, body: GradedBody, rows: list[int], objects: set[int] | None
    ) -> dict[str, Any]:
        """Measures of what a body sees in some rows of the trace."""
        met = {
            row: [self._met(look, objects) for look in episode.looks[row] if look.object == body.index] for row in rows
        }
        seen = [row for row in rows if any(met[row])]
        return {
            "number": len({index for row in seen for hits in met[row] for index in hits}),
            "beams": max(sum(map(len, met[row])) for row in rows),
            "first": float(episode.trace.time[seen[0]]) if seen else None,
            "seconds": sum(row > 0 for row in seen) * episode.trace.step_time,
        }

    def _met(self, look: Look, objects: set[int] | None) -> list[int]:
        """The objects that the beams of a look hit, one for each beam that counts."""
        if self.by is not None and look.by != self.by:
            return []
        return [
            index
            for index, velocity in zip(look.met.tolist(), look.radial.tolist(), strict=True)
            if (objects is None or index in objects)
            and (self.radial is None or (velocity == velocity and matches(self.radial, velocity, "speed")))
        ]
