"""``travel``: how far bodies get from where they started, and whether they stop."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("travel")
class Travel(EpisodePredicate):
    """How far every body of a selection gets. An empty selection fails."""

    of: str
    """Name of the selection."""
    farthest: Match | None = None
    """Accepted values of the greatest distance from the start [m]; 0 for a body that stays."""
    path: Match | None = None
    """Accepted lengths of the path driven [m]."""
    dx: Match | None = None
    """Accepted differences of x from start to end [m]."""
    dy: Match | None = None
    """Accepted differences of y from start to end [m]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Measure the paths."""
        bodies = material.bodies(episode.scene, self.of)
        wanted = {"farthest": self.farthest, "path": self.path, "dx": self.dx, "dy": self.dy}
        words = ", ".join(f"{name} {match.words()} m" for name, match in wanted.items() if match is not None)
        expected = f"{self.of}: {words}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        found, wrong = [], []
        for body in bodies:
            way = episode.positions(body.index)
            seen = {
                "farthest": float(np.hypot(*(way - way[0]).T).max()),
                "path": float(np.hypot(*np.diff(way, axis=0).T).sum()),
                "dx": float(way[-1, 0] - way[0, 0]),
                "dy": float(way[-1, 1] - way[0, 1]),
            }
            text = ", ".join(f"{key} {show(seen[key])}" for key, match in wanted.items() if match is not None)
            found.append((body, text))
            if any(match is not None and not matches(match, seen[key], "length") for key, match in wanted.items()):
                wrong.append((body, text))
        return Observation(not wrong, expected, summary(wrong or found), f"{bodies[0].entry}.behavior")
