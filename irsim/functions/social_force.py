"""Social forces for arrays; the engine computes them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.functions._decide import behavior_options, decide

__all__ = ["SocialForceModelBatch", "social_force_model"]

Floats = NDArray[np.float64]
_UNCAPPED = 1e9
_PERIOD = 1e-3


class SocialForceModelBatch:
    """Pedestrians that decide at once, together with those they walk with.

    Args:
        states: [x, y, vx, vy, radius, wanted vx, wanted vy, theta] of each, world frame.
        neighbor_states: [x, y, vx, vy, radius] of others.
        line_obs_list: [x1, y1, x2, y2] of lines.
        social_groups: Lists of indices of those who walk together.
        vmax: Speed cap [m/s].
        step_time: Period [s].
        neighbor_range: Others farther away are ignored [m].
        **parameters: Other options of ``sfm``: relaxation_time, force_factor_desired, …

    Raises:
        ValidationError: A parameter does not fit.
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
        self.step_time = step_time
        self.parameters: dict[str, Any] = {
            "vmax": vmax,
            "relaxation_time": relaxation_time,
            "force_factor_desired": force_factor_desired,
            "force_factor_social": force_factor_social,
            "force_factor_obstacle": force_factor_obstacle,
            "sigma_obstacle": sigma_obstacle,
            "lambda_importance": lambda_importance,
            "gamma": gamma,
            "n_angular": n_angular,
            "n_velocity": n_velocity,
            "neighbor_threshold": neighbor_range,
            "safety_radius": safety_radius,
            "force_factor_coherence": force_factor_coherence,
            "force_factor_group_repulsion": force_factor_group_repulsion,
            "group_repulsion_threshold": group_repulsion_threshold,
            "force_factor_gaze": force_factor_gaze,
            "gaze_vision_angle": gaze_vision_angle,
        }
        self.update(states, neighbor_states, line_obs_list, social_groups)

    def update(
        self,
        states: Any,
        neighbor_states: Any = None,
        line_obs_list: Any = None,
        social_groups: list[list[int]] | None = None,
    ) -> None:
        """Another moment: arguments as of the constructor."""
        self.states = [list(map(float, state)) for state in states]
        self.neighbor_states = [
            list(map(float, state)) for state in ([] if neighbor_states is None else neighbor_states)
        ]
        self.line_obs_list = [list(map(float, line)) for line in ([] if line_obs_list is None else line_obs_list)]
        self.social_groups = social_groups

    @property
    def n(self) -> int:
        """How many decide."""
        return len(self.states)

    def _decided(self, step_time: float, **parameters: Any) -> Floats:
        keys = {**self.parameters, "social_groups": self.social_groups, **parameters}
        options = behavior_options("sfm", keys)
        grouped = self.social_groups is not None or self.n > 1
        agents, others, lines = self.states, self.neighbor_states, self.line_obs_list
        return decide(options, agents, others, lines, grouped=grouped, step_time=step_time)

    def cal_vel(self) -> Floats:
        """(n, 2) velocities at the end of the period [m/s], world frame."""
        pushed = self._decided(self.step_time, force_factor_desired=0.0, vmax=_UNCAPPED)
        free = pushed + self.step_time * self.parameters["force_factor_desired"] * self.desired_force()
        speed = np.linalg.norm(free, axis=1, keepdims=True)
        vmax = float(self.parameters["vmax"])
        capped: Floats = np.where(speed > vmax, free * (vmax / np.where(speed > 0, speed, 1.0)), free)
        return capped

    def _force(self, factor: str) -> Floats:
        """(n, 2) one force alone, its weight left out."""
        factors = ("desired", "social", "obstacle", "coherence", "group_repulsion", "gaze")
        alone = {f"force_factor_{name}": float(name == factor) for name in factors}
        now = np.array([state[2:4] for state in self.states])
        force: Floats = (self._decided(_PERIOD, **alone, vmax=_UNCAPPED) - now) / _PERIOD
        return force

    def desired_force(self) -> Floats:
        """(n, 2) pull to the wanted velocity [m/s^2]."""
        change = np.array([[state[5] - state[2], state[6] - state[3]] for state in self.states])
        return np.asarray(change / self.parameters["relaxation_time"])

    def social_force(self) -> Floats:
        """(n, 2) push away from others [m/s^2]."""
        return self._force("social")

    def obstacle_force(self) -> Floats:
        """(n, 2) push away from lines [m/s^2]."""
        return self._force("obstacle")

    def coherence_force(self) -> Floats:
        """(n, 2) pull to the middle of one's social group [m/s^2]."""
        return self._force("coherence")

    def group_repulsive_force(self) -> Floats:
        """(n, 2) push away from too close members of one's social group [m/s^2]."""
        return self._force("group_repulsion")

    def gaze_force(self) -> Floats:
        """(n, 2) slowing down to see one's social group [m/s^2]."""
        return self._force("gaze")


class social_force_model:
    """One pedestrian.

    Args:
        state: [x, y, vx, vy, radius, wanted vx, wanted vy, theta], world frame.
        neighbor_list: [x, y, vx, vy, radius] of others.
        line_obs_list: [x1, y1, x2, y2] of lines.
        vmax: Speed cap [m/s].
        step_time: Period [s].
        relaxation_time: Time to reach the wanted velocity [s].
        force_factor_desired, force_factor_social, force_factor_obstacle: Weights.
        sigma_obstacle: Reach of lines [m].
        lambda_importance, gamma, n_angular, n_velocity: Of the push away from others, see ``sfm``.
        neighbor_range: Others farther away are ignored [m].
        safety_radius: Distance kept round each of two [m].

    Raises:
        ValidationError: A parameter does not fit.
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
        self._model = SocialForceModelBatch(
            [state],
            neighbor_list,
            line_obs_list,
            None,
            vmax,
            step_time,
            relaxation_time,
            force_factor_desired,
            force_factor_social,
            force_factor_obstacle,
            sigma_obstacle,
            lambda_importance,
            gamma,
            n_angular,
            n_velocity,
            neighbor_range,
            safety_radius,
        )

    def update(
        self,
        state: Sequence[float],
        neighbor_list: Sequence[Sequence[float]],
        line_obs_list: Sequence[Sequence[float]] | None = None,
    ) -> None:
        """Another moment: arguments as of the constructor."""
        self._model.update([state], neighbor_list, line_obs_list)

    def cal_vel(self) -> list[float]:
        """[vx, vy] at the end of the period [m/s], world frame."""
        return [float(value) for value in self._model.cal_vel()[0]]

    def desired_force(self) -> list[float]:
        """[x, y] pull to the wanted velocity [m/s^2]."""
        return [float(value) for value in self._model.desired_force()[0]]

    def social_force(self) -> list[float]:
        """[x, y] push away from others [m/s^2]."""
        return [float(value) for value in self._model.social_force()[0]]

    def obstacle_force(self) -> list[float]:
        """[x, y] push away from lines [m/s^2]."""
        return [float(value) for value in self._model.obstacle_force()[0]]
