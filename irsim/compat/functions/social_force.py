"""The social force model for lists of pedestrians; the core computes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.compat.functions._decide import behavior_options, decide

__all__ = ["SocialForceModelBatch", "social_force_model"]

_UNLIMITED_SPEED_M_S = 1e7
_FORCE_PERIOD_S = 1e-3
"""Period [s] over which a force is measured as a change of velocity."""
_NO_OPTIONS = (
    *("self", "states", "neighbor_states", "line_obs_list", "social_groups", "step_time"),
    "neighbor_range",  # an option by another name
)
"""Arguments of the model which ``sfm`` does not have among its options."""


class SocialForceModelBatch:
    """Pedestrians that decide at the same time, some of them in social groups.

    Args:
        states: [x, y, vx, vy, radius, wanted vx, wanted vy, theta] of each pedestrian, world frame.
        neighbor_states: [x, y, vx, vy, radius] of each other moving object.
        line_obs_list: [x1, y1, x2, y2] of each line obstacle.
        social_groups: For each group, the list of indices of the pedestrians that walk together.
        vmax: Highest speed [m/s].
        step_time: Period [s].
        neighbor_range: Neighbors farther away are ignored [m].
        **parameters: Other options of ``sfm``: relaxation_time, force_factor_desired, …

    Raises:
        ValidationError: A parameter is not valid.
    """

    def __init__(
        self,
        states: Any,
        neighbor_states: Any = None,
        line_obs_list: Any = None,
        social_groups: list[list[int]] | None = None,
        vmax: float = 1.5,
        step_time: float = 0.1,
        relaxation_time: float = 0.5,
        force_factor_desired: float = 1.0,
        force_factor_social: float = 2.1,
        force_factor_obstacle: float = 10.0,
        sigma_obstacle: float = 0.8,
        lambda_importance: float = 2.0,
        gamma: float = 0.35,
        n_angular: float = 2.0,
        n_velocity: float = 3.0,
        neighbor_range: float = 10.0,
        safety_radius: float = 0.0,
        force_factor_coherence: float = 2.0,
        force_factor_group_repulsion: float = 1.0,
        group_repulsion_threshold: float | None = None,
        force_factor_gaze: float = 3.0,
        gaze_vision_angle: float = 90.0,
    ) -> None:
        given = {name: value for name, value in locals().items() if name not in _NO_OPTIONS}
        self.parameters: dict[str, Any] = {**given, "neighbor_threshold": neighbor_range}
        self.step_time = step_time
        self.update(states, neighbor_states, line_obs_list, social_groups)

    def update(
        self,
        states: Any,
        neighbor_states: Any = None,
        line_obs_list: Any = None,
        social_groups: list[list[int]] | None = None,
    ) -> None:
        """Replace the states; the arguments are as for the constructor."""
        self.states = [list(map(float, state)) for state in states]
        self.neighbor_states = [
            list(map(float, state)) for state in ([] if neighbor_states is None else neighbor_states)
        ]
        self.line_obs_list = [list(map(float, line)) for line in ([] if line_obs_list is None else line_obs_list)]
        self.social_groups = social_groups

    @property
    def n(self) -> int:
        """Number of pedestrians."""
        return len(self.states)

    def _next_velocities(self, step_time: float, **parameters: Any) -> Floats:
        keys = {**self.parameters, "social_groups": self.social_groups, "keep_gap": False, **parameters}  # forces alone
        options = behavior_options("sfm", keys)
        grouped = self.social_groups is not None or self.n > 1
        agents, others, lines = self.states, self.neighbor_states, self.line_obs_list
        return decide(options, agents, others, lines, grouped=grouped, step_time=step_time)

    def cal_vel(self) -> Floats:
        """Return the (n, 2) velocities at the end of the period [m/s], world frame."""
        pushed = self._next_velocities(self.step_time, force_factor_desired=0.0, vmax=_UNLIMITED_SPEED_M_S)
        free = pushed + self.step_time * self.parameters["force_factor_desired"] * self.desired_force()
        speed = np.linalg.norm(free, axis=1, keepdims=True)
        vmax = float(self.parameters["vmax"])
        capped: Floats = np.where(speed > vmax, free * (vmax / np.where(speed > 0, speed, 1.0)), free)
        return capped

    def _force(self, factor: str) -> Floats:
        """Return the (n, 2) accelerations of a single force, computed with a weight of 1."""
        factors = ("desired", "social", "obstacle", "coherence", "group_repulsion", "gaze")
        weights = {f"force_factor_{name}": float(name == factor) for name in factors}
        before = np.array([state[2:4] for state in self.states])
        after = self._next_velocities(_FORCE_PERIOD_S, **weights, vmax=_UNLIMITED_SPEED_M_S)
        force: Floats = (after - before) / _FORCE_PERIOD_S
        return force

    def desired_force(self) -> Floats:
        """Return the (n, 2) attraction to the wanted velocity [m/s^2]."""
        change = np.array([[state[5] - state[2], state[6] - state[3]] for state in self.states])
        return np.asarray(change / self.parameters["relaxation_time"])

    def social_force(self) -> Floats:
        """Return the (n, 2) repulsion by neighbors [m/s^2]."""
        return self._force("social")

    def obstacle_force(self) -> Floats:
        """Return the (n, 2) repulsion by line obstacles [m/s^2]."""
        return self._force("obstacle")

    def coherence_force(self) -> Floats:
        """Return the (n, 2) attraction to the centre of the social group [m/s^2]."""
        return self._force("coherence")

    def group_repulsive_force(self) -> Floats:
        """Return the (n, 2) repulsion by members of the social group that are too close [m/s^2]."""
        return self._force("group_repulsion")

    def gaze_force(self) -> Floats:
        """Return the (n, 2) deceleration that keeps the social group in view [m/s^2]."""
        return self._force("gaze")


class social_force_model:
    """A single pedestrian.

    Args:
        state: [x, y, vx, vy, radius, wanted vx, wanted vy, theta], world frame.
        neighbor_list: [x, y, vx, vy, radius] of each other moving object.
        line_obs_list: [x1, y1, x2, y2] of each line obstacle.
        vmax: Highest speed [m/s].
        step_time: Period [s].
        relaxation_time: Time to reach the wanted velocity [s].
        force_factor_desired, force_factor_social, force_factor_obstacle: Weights of the forces.
        sigma_obstacle: Decay length of the repulsion by line obstacles [m].
        lambda_importance, gamma, n_angular, n_velocity: Parameters of the repulsion by neighbors, see ``sfm``.
        neighbor_range: Neighbors farther away are ignored [m].
        safety_radius: Distance added to the radius of both pedestrians of a pair [m].

    Raises:
        ValidationError: A parameter is not valid.
    """

    def __init__(
        self,
        state: Sequence[float],
        neighbor_list: Sequence[Sequence[float]] | None = None,
        line_obs_list: Sequence[Sequence[float]] | None = None,
        vmax: float = 1.5,
        step_time: float = 0.1,
        relaxation_time: float = 0.5,
        force_factor_desired: float = 1.0,
        force_factor_social: float = 2.1,
        force_factor_obstacle: float = 10.0,
        sigma_obstacle: float = 0.8,
        lambda_importance: float = 2.0,
        gamma: float = 0.35,
        n_angular: float = 2.0,
        n_velocity: float = 3.0,
        neighbor_range: float = 10.0,
        safety_radius: float = 0.0,
    ) -> None:
        given = {name: value for name, value in locals().items() if name not in ("self", "state", "neighbor_list")}
        self._model = SocialForceModelBatch([state], neighbor_list, **given)

    def update(
        self,
        state: Sequence[float],
        neighbor_list: Sequence[Sequence[float]],
        line_obs_list: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Replace the states; the arguments are as for the constructor."""
        self._model.update([state], neighbor_list, line_obs_list)

    def cal_vel(self) -> list[float]:
        """Return [vx, vy] at the end of the period [m/s], world frame."""
        return [float(value) for value in self._model.cal_vel()[0]]

    def desired_force(self) -> list[float]:
        """Return the [x, y] attraction to the wanted velocity [m/s^2]."""
        return [float(value) for value in self._model.desired_force()[0]]

    def social_force(self) -> list[float]:
        """Return the [x, y] repulsion by neighbors [m/s^2]."""
        return [float(value) for value in self._model.social_force()[0]]

    def obstacle_force(self) -> list[float]:
        """Return the [x, y] repulsion by line obstacles [m/s^2]."""
        return [float(value) for value in self._model.obstacle_force()[0]]
