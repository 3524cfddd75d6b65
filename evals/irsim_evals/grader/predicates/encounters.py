"""Encounters of bodies in an episode: collisions, distances, and who comes nearer."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
import shapely.affinity

from irsim_evals.grader.episode import dense
from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.outcome import Mark
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, register, summary
from irsim_evals.grader.selection import Selection

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material

_SLIDE = 0.02
"""Distance [m] that two bodies move relative to each other between two looks at how near they are."""


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

    def observe(self, material: Material, episode: GradedEpisode) -> Observation:
        """Measure at every step."""
        first, second = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.to)
        expected = f"smallest distance of {self.of} to {self.to}: {self.distance.words()} m"
        pairs = [(a, b) for a in first for b in second if a is not b]
        if not pairs:
            return Observation(False, expected, "no pair of bodies")
        least, a, b = min(((closest(episode, a, b), a, b) for a, b in pairs), key=lambda entry: entry[0])
        seen = f"{a.name} and {b.name}: {show(least)} m"
        return Observation(matches(self.distance, least, "length"), expected, seen, a.entry)


def closest(episode: GradedEpisode, a: GradedBody, b: GradedBody) -> float:
    """The smallest distance between the footprints of two bodies during an episode, within steps, too [m]."""
    poses = episode.trace.pose[:, [a.index, b.index]]
    poses = poses[~np.isnan(poses[:, :, 0]).any(axis=1)]
    if not len(poses):
        return math.inf  # they never meet in the world
    poses[:, :, 2] = np.unwrap(poses[:, :, 2], axis=0)
    far = np.hypot(*np.diff(poses[:, 0] - poses[:, 1], axis=0)[:, :2].T).max(initial=0.0)
    first, second = np.hsplit(dense(poses.reshape(-1, 6), math.ceil(far / _SLIDE)), 2)
    centers = np.hypot(*(first[:, :2] - second[:, :2]).T)
    reach = sum(float(shapely.hausdorff_distance(shapely.Point(c.pose[:2]), c.footprint)) for c in (a, b))
    near = np.flatnonzero(centers <= centers.min() + (0.0 if a.radius and b.radius else reach))
    return min(edge_to_edge((a, first[row]), (b, second[row])) for row in near.tolist())


def edge_to_edge(*placed: tuple[GradedBody, Any]) -> float:
    """Distance between the footprints of two bodies at their poses [m]; negative where two discs overlap."""
    (a, first), (b, second) = placed
    if a.radius is not None and b.radius is not None:
        return math.dist(first[:2], second[:2]) - a.radius - b.radius
    return float(shapely.distance(_moved(a, first), _moved(b, second)))


def _moved(body: GradedBody, pose: Any) -> Any:
    if body.kinematics is None:
        return body.footprint
    x, y, heading = body.pose
    turned = shapely.affinity.rotate(body.footprint, float(pose[2]) - heading, origin=(x, y), use_radians=True)
    return shapely.affinity.translate(turned, float(pose[0]) - x, float(pose[1]) - y)
