"""``separation``: the smallest distance between the edges of bodies during an episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
import shapely.affinity

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.body import Body
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("separation")
class Separation(EpisodePredicate):
    """The smallest distance between the bodies of two selections, edge to edge, at any time of the episode."""

    of: str
    """Name of the first selection."""
    to: str
    """Name of the second selection."""
    distance: Match
    """Accepted values of the smallest distance [m]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Measure at every step."""
        first, second = material.bodies(episode.scene, self.of), material.bodies(episode.scene, self.to)
        expected = f"smallest distance of {self.of} to {self.to}: {self.distance.words()} m"
        pairs = [(a, b) for a in first for b in second if a is not b]
        if not pairs:
            return Observation(False, expected, "no pair of bodies")
        least, a, b = min(((closest(episode, a, b), a, b) for a, b in pairs), key=lambda found: found[0])
        return Observation(
            matches(self.distance, least, "length"), expected, f"{a.name} and {b.name}: {show(least)} m", a.entry
        )


def closest(episode: Episode, a: Body, b: Body) -> float:
    """The smallest distance between the footprints of two bodies during an episode [m]."""
    first, second = episode.trace.pose[:, a.index], episode.trace.pose[:, b.index]
    centers = np.hypot(*(first[:, :2] - second[:, :2]).T)
    if a.radius is not None and b.radius is not None:
        return float(centers.min()) - a.radius - b.radius
    reach = sum(float(shapely.hausdorff_distance(shapely.Point(c.pose[:2]), c.footprint)) for c in (a, b))
    near = np.flatnonzero(centers <= centers.min() + reach)
    return min(float(shapely.distance(_moved(a, first[row]), _moved(b, second[row]))) for row in near.tolist())


def _moved(body: Body, pose: Any) -> Any:
    if body.static:
        return body.footprint
    x, y, heading = body.pose
    turned = shapely.affinity.rotate(body.footprint, float(pose[2]) - heading, origin=(x, y), use_radians=True)
    return shapely.affinity.translate(turned, float(pose[0]) - x, float(pose[1]) - y)
