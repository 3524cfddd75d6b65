"""``roams``: bodies use all parts of the world and never come to an end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Quantity
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("roams")
class Roams(EpisodePredicate):
    """In the second half of the episode each quadrant of the world holds a share of the positions."""

    of: str
    """Name of the selection."""
    share: Quantity
    """Least share of the positions in each quadrant."""
    endless: bool = True
    """None of them may come to rest for the last fifth of the episode."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Count positions."""
        bodies = material.bodies(episode.scene, self.of)
        expected = f"each quadrant holds {self.share:.0%} of the positions of {self.of}"
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        x0, y0, x1, y1 = episode.scene.bounds
        half = len(episode.trace) // 2
        points = episode.trace.pose[half:, [body.index for body in bodies], :2].reshape(-1, 2)
        right, up = points[:, 0] > (x0 + x1) / 2, points[:, 1] > (y0 + y1) / 2
        shares = [float(np.mean((right == a) & (up == b))) for a in (False, True) for b in (False, True)]
        tail = episode.trace.pose[-max(2, len(episode.trace) // 5) :]
        rest = [b.name for b in bodies if np.ptp(tail[:, b.index, :2], axis=0).max() < 0.05]
        observed = ", ".join(f"{share:.0%}" for share in shares)
        if rest and self.endless:
            observed += f"; {rest[0]} has stopped"
        passed = min(shares) >= self.share and not (rest and self.endless)
        return Observation(passed, expected, observed, f"{bodies[0].entry}.behavior")
