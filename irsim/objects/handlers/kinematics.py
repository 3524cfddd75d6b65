"""Drives as objects: what ``robot.kf`` is, and what users derive their own from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from irsim.common.arrays import Floats
from irsim.components.kinematics._handler import KinematicsHandler, handler_class, register_kinematics
from irsim.functions.drives import (
    ackermann_kinematics,
    differential_kinematics,
    omni_angular_kinematics,
    omni_kinematics,
)
from irsim.options.colors import OBSTACLE_COLOR, PUSHABLE_COLOR

__all__ = [
    "AckermannKinematics",
    "DifferentialKinematics",
    "KinematicsFactory",
    "KinematicsHandler",
    "OmniAngularKinematics",
    "OmniKinematics",
    "PassiveKinematics",
    "register_kinematics",
]

_FRICTION_STOP = 1e-12


class DifferentialKinematics(KinematicsHandler):
    """Differential drive: forward speed and yaw rate."""

    yaw_rate_row: ClassVar[int | None] = 1

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state (3, 1) one period later."""
        return differential_kinematics(state, velocity, step_time, self.noise, self.alpha)


class AckermannKinematics(KinematicsHandler):
    """Car: forward speed and steering angle, or its rate."""

    state_dim: ClassVar[int] = 4
    min_state_dim: ClassVar[int] = 4
    color_key: ClassVar[str] = "robot_acker"
    description: ClassVar[str | None] = "car_green.png"

    def __init__(
        self,
        name: str = "acker",
        noise: bool = False,
        alpha: Sequence[float] | None = None,
        mode: str = "steer",
        wheelbase: float = 1.0,
    ) -> None:
        super().__init__(name, noise, alpha)
        self.mode = mode
        self.wheelbase = wheelbase

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state (4, 1) one period later."""
        return ackermann_kinematics(state, velocity, step_time, self.noise, self.alpha, self.mode, self.wheelbase)


class OmniKinematics(KinematicsHandler):
    """Holonomic drive of fixed heading: forward and lateral speed in the body frame."""

    show_arrow: ClassVar[bool] = False
    translation_rows: ClassVar[tuple[int, ...]] = (0, 1)

    def __init__(self, name: str = "omni", noise: bool = False, alpha: Sequence[float] | None = None) -> None:
        super().__init__(name, noise, [0.03, 0.03] if alpha is None else alpha)

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state (3, 1) one period later."""
        return omni_kinematics(state, velocity, step_time, self.noise, self.alpha)

    def velocity_to_xy(self, state: Floats, velocity: Floats) -> Floats:
        """(2, 1) world-frame velocity of a control."""
        return _turned(velocity, float(state[2, 0]))

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """(2, 1) control of a world-frame velocity."""
        return _turned(velocity_xy, -float(state[2, 0]))

    def compute_max_speed(self, vel_max: Floats) -> float:
        """Length of the upper limits [m/s]."""
        return float(np.hypot(*np.asarray(vel_max, dtype=np.float64).reshape(-1)[:2]))

    def compute_heading(self, state: Floats, velocity: Floats) -> float:
        """Direction of travel [rad], not wrapped."""
        forward, lateral = np.asarray(velocity, dtype=np.float64).reshape(-1)[:2]
        return math.atan2(lateral, forward) + float(state[2, 0])


class OmniAngularKinematics(OmniKinematics):
    """Holonomic drive that also turns: forward and lateral speed in the body frame, yaw rate."""

    action_dim: ClassVar[int] = 3
    vel_max: ClassVar[Sequence[float]] = [1, 1, 1]
    vel_min: ClassVar[Sequence[float]] = [-1, -1, -1]
    acce: ClassVar[Sequence[float]] = [math.inf] * 3
    show_arrow: ClassVar[bool] = True
    yaw_rate_row: ClassVar[int | None] = 2

    def __init__(self, name: str = "omni_angular", noise: bool = False, alpha: Sequence[float] | None = None) -> None:
        super().__init__(name, noise, [0.03, 0.03, 0.03] if alpha is None else alpha)

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state (3, 1) one period later."""
        return omni_angular_kinematics(state, velocity, step_time, self.noise, self.alpha)

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """(3, 1) control of a world-frame velocity, without turning."""
        return np.vstack([_turned(velocity_xy, -float(state[2, 0])), [[0.0]]])

    def compute_heading(self, state: Floats, velocity: Floats) -> float:
        """Heading of the body [rad]."""
        return float(state[2, 0])


class PassiveKinematics(KinematicsHandler):
    """Nothing drives it: it keeps its world-frame velocity (vx, vy, yaw rate), and slows down by friction."""

    action_dim: ClassVar[int] = 3
    vel_max: ClassVar[Sequence[float]] = [1, 1, 1]
    vel_min: ClassVar[Sequence[float]] = [-1, -1, -1]
    acce: ClassVar[Sequence[float]] = [math.inf] * 3
    show_arrow: ClassVar[bool] = False
    passive: ClassVar[bool] = True
    default_mass: ClassVar[float] = math.inf
    translation_rows: ClassVar[tuple[int, ...]] = (0, 1)
    yaw_rate_row: ClassVar[int | None] = 2

    def __init__(self, name: str | None = None, noise: bool = False, alpha: Sequence[float] | None = None) -> None:
        super().__init__(name or "static", noise, alpha)

    @classmethod
    def default_color(cls, role: str, pushable: bool = False) -> str:
        """Colour of an object that the scenario gives none."""
        return PUSHABLE_COLOR if pushable else OBSTACLE_COLOR

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """The state (3, 1) one period later."""
        moved = np.array(state, dtype=np.float64)
        moved[:3, 0] += np.asarray(velocity, dtype=np.float64).reshape(-1)[:3] * step_time
        return moved

    def coast(
        self, velocity: Floats, step_time: float, friction: float, gyration: float = 0.0, gravity: float = 9.81
    ) -> Floats:
        """(3, 1) velocity of the next period: slowed down by friction on the ground, to rest at most."""
        after = np.array(velocity, dtype=np.float64).reshape(-1, 1)
        loss = friction * gravity * step_time
        speed, rate = float(np.hypot(after[0, 0], after[1, 0])), abs(float(after[2, 0]))
        after[:2] *= max(0.0, speed - loss) / speed if speed > _FRICTION_STOP else 0.0
        if gyration > 0:
            after[2] *= max(0.0, rate - loss / gyration) / rate if rate > _FRICTION_STOP else 0.0
        return after

    def velocity_to_xy(self, state: Floats, velocity: Floats) -> Floats:
        """(2, 1) world-frame velocity: the velocity's own."""
        return np.asarray(velocity, dtype=np.float64).reshape(-1, 1)[:2]

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """(3, 1) the same without turning."""
        return np.vstack([np.asarray(velocity_xy, dtype=np.float64).reshape(-1, 1)[:2], [[0.0]]])

    def compute_max_speed(self, vel_max: Floats) -> float:
        """Nothing drives it: 0."""
        return 0.0


def _turned(vector: Floats, angle: float) -> Floats:
    """(2, 1) the first two numbers, turned."""
    x, y = np.asarray(vector, dtype=np.float64).reshape(-1)[:2]
    cosine, sine = math.cos(angle), math.sin(angle)
    return np.array([[x * cosine - y * sine], [x * sine + y * cosine]])


_BUILT_IN: dict[str, type[KinematicsHandler]] = {
    "acker": AckermannKinematics,
    "diff": DifferentialKinematics,
    "omni": OmniKinematics,
    "omni_angular": OmniAngularKinematics,
    "static": PassiveKinematics,
}


class KinematicsFactory:
    """Makes handlers by name."""

    @staticmethod
    def create_kinematics(
        name: str | None = None,
        noise: bool = False,
        alpha: Sequence[float] | None = None,
        mode: str | None = None,
        wheelbase: float | None = None,
        role: str = "robot",
        tau: float | None = None,
        *,
        shape_wheelbase: float | None = None,
        **kwargs: Any,
    ) -> KinematicsHandler:
        """The handler of a drive.

        Args:
            name: Of the drive; None is ``diff``.
            noise: Whether it has motion noise.
            alpha: Parameters of the noise.
            mode: Of ``acker``.
            wheelbase: Distance of the axles [m].
            role: ``robot`` or ``obstacle``; nothing depends on it.
            tau: Lag in ``collision_mode: contact`` [s].
            shape_wheelbase: Used where ``wheelbase`` is not given.
            **kwargs: For the constructor of a drive of user code.

        Raises:
            NotImplementedError: There is none of that name.
            TypeError: The constructor does not take these keys.
        """
        key = (name or "diff").lower()
        maker: Any = KinematicsFactory.get_handler_class(key)
        if maker is None:
            raise NotImplementedError(f"kinematics {name!r} is not registered")
        if key == "acker":
            kwargs |= {"mode": mode or "steer", "wheelbase": wheelbase or shape_wheelbase or 1.0}
        elif key not in _BUILT_IN:
            kwargs |= {k: v for k, v in (("mode", mode), ("wheelbase", wheelbase)) if v is not None}
        handler: KinematicsHandler = maker(key, noise, alpha, **kwargs)
        handler.tau = tau
        return handler

    @staticmethod
    def get_handler_class(name: str) -> type[KinematicsHandler] | None:
        """The class of a drive, None if there is none."""
        return _BUILT_IN.get(name.lower()) or handler_class(name.lower())
