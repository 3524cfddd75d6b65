"""Things that bodies see with their sensors or their field of view."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from irsim.options.registry import SENSORS
from irsim_evals.grader.matching import Kind, Match, Quantity, matches
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, OfBodies, measured, register
from irsim_evals.grader.selection import Selection
from irsim_evals.grader.words import OneOf

if TYPE_CHECKING:
    from irsim_evals.grader.body import GradedBody
    from irsim_evals.grader.episode import GradedEpisode, Look
    from irsim_evals.grader.material import Material

_SIGHT: dict[str, Kind] = {"number": "count", "beams": "count", "first": "time", "seconds": "time"}
"""Measures of what is seen."""


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
