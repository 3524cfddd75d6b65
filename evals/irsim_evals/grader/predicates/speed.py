"""``speed``: how fast bodies really move, forwards and backwards."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from irsim_evals.grader.matching import Match, matches, show
from irsim_evals.grader.predicates._base import EpisodePredicate, Observation, register, summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import Episode
    from irsim_evals.grader.material import Material


@register("speed")
class Speed(EpisodePredicate):
    """Measured speeds of every body of a selection. An empty selection fails."""

    of: str
    """Name of the selection."""
    highest: Match | None = None
    """Accepted values of the greatest speed along the heading [m/s]; of omnidirectional drives, in any direction."""
    lowest: Match | None = None
    """Accepted values of the smallest signed speed along the heading [m/s]; negative in reverse."""
    turn: Match | None = None
    """Accepted values of the greatest turn rate [rad/s]."""

    def observe(self, material: Material, episode: Episode) -> Observation:
        """Measure from step to step."""
        bodies = material.bodies(episode.scene, self.of)
        wanted = {"highest": self.highest, "lowest": self.lowest, "turn": self.turn}
        expected = ", ".join(f"{name} {match.words()}" for name, match in wanted.items() if match is not None)
        if not bodies:
            return Observation(False, expected, f"{self.of}: no body")
        found, wrong = [], []
        for body in bodies:
            along = episode.speeds(body.index)
            pose = episode.trace.pose[:, body.index]
            moved = np.hypot(*np.diff(pose[:, :2], axis=0).T) / episode.trace.step_time
            turned = np.abs(np.diff(np.unwrap(pose[:, 2]))) / episode.trace.step_time
            everywhere = body.kinematics in ("omni", "omni_angular")
            seen = {
                "highest": float((moved if everywhere else along).max()),
                "lowest": float(along.min()),
                "turn": float(turned.max()),
            }
            shown = {key: seen[key] for key, match in wanted.items() if match is not None}
            off = [k for k, m in wanted.items() if m is not None and not matches(m, seen[k], "speed")]
            text = ", ".join(f"{key} {show(value)}" for key, value in shown.items())
            found.append((body, text))
            if off:
                wrong.append((body, text))
        return Observation(
            not wrong,
            f"{self.of}: {expected}",
            summary(wrong or found),
            f"{bodies[0].entry}.vel_max" if wrong else None,
        )
