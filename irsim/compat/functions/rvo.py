"""Reciprocal velocity obstacles for a single agent; the core computes them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from irsim.compat.functions._decide import behavior_options, decide

__all__ = ["reciprocal_vel_obs"]

_RANGE_MARGIN_M = 1.0
"""Added to the distance of the farthest neighbor [m], so that no neighbor is ignored."""


class reciprocal_vel_obs:
    """Chooses a velocity that avoids collisions.

    Args:
        state: [x, y, vx, vy, radius, wanted vx, wanted vy, theta], world frame.
        obs_state_list: [x, y, vx, vy, radius] of each other moving object.
        vxmax, vymax: Highest speed along x and y that the search considers [m/s].
        acce: Half width of the search around the present velocity [m/s].
        factor: Weight of the time to collision if every velocity leads to a collision.
        line_obs_list: [x1, y1, x2, y2] of each line obstacle.
    """

    def __init__(
        self,
        state: Sequence[float],
        obs_state_list: Sequence[Sequence[float]] | None = None,
        vxmax: float = 1.5,
        vymax: float = 1.5,
        acce: float = 0.5,
        factor: float = 1.0,
        line_obs_list: Sequence[Sequence[float]] | None = None,
    ) -> None:
        self.vxmax, self.vymax, self.acce, self.factor = vxmax, vymax, acce, factor
        self.update(state, obs_state_list or [], line_obs_list)

    def update(
        self,
        state: Sequence[float],
        obs_state_list: Sequence[Sequence[float]],
        line_obs_list: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Replace the states; the arguments are as for the constructor."""
        self.state = list(state)
        self.obs_state_list = list(obs_state_list)
        self.line_obs_list = list(line_obs_list or [])

    def cal_vel(self, mode: str = "rvo") -> list[float]:
        """Choose a velocity.

        Args:
            mode: ``rvo``, ``hrvo`` or ``vo``.

        Returns:
            [vx, vy] in the world frame [m/s].

        Raises:
            ValueError: The mode is unknown.
        """
        if mode not in ("rvo", "hrvo", "vo"):
            raise ValueError(f"unknown mode {mode!r}: choose rvo, hrvo or vo")
        x, y = self.state[:2]
        farthest = max((math.hypot(o[0] - x, o[1] - y) for o in self.obs_state_list), default=0.0)
        keys = {"vxmax": self.vxmax, "vymax": self.vymax, "acce": self.acce, "factor": self.factor, "mode": mode}
        options = behavior_options("rvo", {**keys, "neighbor_threshold": farthest + _RANGE_MARGIN_M})
        vx, vy = decide(options, [self.state], self.obs_state_list, self.line_obs_list)[0]
        return [float(vx), float(vy)]
