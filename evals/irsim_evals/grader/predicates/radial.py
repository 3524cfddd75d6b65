"""``radial``: beams of an FMCW lidar that see something come nearer, and something go away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, Quantity, matches
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("radial")
class Radial(EpisodePredicate):
    """How many beams measure a radial velocity below and above a threshold."""

    of: str
    """Selection of the one body with the sensor."""
    at: Quantity
    """Time of the scan [s]."""
    faster_than: Quantity
    """Threshold [m/s]."""
    approaching: Match
    """Accepted numbers of beams below minus the threshold."""
    receding: Match
    """Accepted numbers of beams above the threshold."""

    def scan_times(self) -> tuple[float, ...]:
        """The one scan."""
        return (self.at,)

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Count the beams."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"beams nearer: {self.approaching.words()}, away: {self.receding.words()}"
        if len(bodies) != 1 or not episode.scans:
            return Observation(False, expected, f"{self.of}: {len(bodies)}")
        time = min(episode.scans, key=lambda seen: abs(seen - self.at))
        for scan in episode.scans[time].get(bodies[0].name, []):
            if "radial_velocity" not in scan:
                continue
            values = np.asarray(scan["radial_velocity"], dtype=float)
            near, away = int((values < -self.faster_than).sum()), int((values > self.faster_than).sum())
            passed = matches(self.approaching, near, "count") and matches(self.receding, away, "count")
            return Observation(passed, expected, f"nearer {near}, away {away}", f"{bodies[0].entry}.sensors")
        return Observation(False, expected, "no sensor measures radial velocities", f"{bodies[0].entry}.sensors")
