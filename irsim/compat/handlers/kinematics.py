"""Drives as objects (``robot.kf``), and the base classes of drives that users write."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from irsim.common.arrays import Floats
from irsim.compat.functions.drives import (
    ackermann_kinematics,
    differential_kinematics,
    omni_angular_kinematics,
    omni_kinematics,
)
from irsim.components.kinematics._handler import KinematicsHandler, handler_class, register_kinematics
from irsim.options.colors import OBSTACLE_COLOR, PUSHABLE_COLOR
from irsim.options.registry import KINEMATICS

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
        """Return the state after one time step, (3, 1)."""
        return differential_kinematics(state, velocity, step_time, self.noise, self.alpha, self.integration)


class AckermannKinematics(KinematicsHandler):
    """Car: forward speed and steering angle, or forward speed and steering rate."""

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
        """Return the state after one time step, (4, 1)."""
        return ackermann_kinematics(
            state, velocity, step_time, self.noise, self.alpha, self.mode, self.wheelbase, self.integration
        )


class OmniKinematics(KinematicsHandler):
    """Holonomic drive of fixed heading: forward and lateral speed in the body frame."""

    show_arrow: ClassVar[bool] = False
    translation_rows: ClassVar[tuple[int, ...]] = (0, 1)

    def __init__(self, name: str = "omni", noise: bool = False, alpha: Sequence[float] | None = None) -> None:
        super().__init__(name, noise, [0.03, 0.03] if alpha is None else alpha)

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """Return the state after one time step, (3, 1)."""
        return omni_kinematics(state, velocity, step_time, self.noise, self.alpha)

    def velocity_to_xy(self, state: Floats, velocity: Floats) -> Floats:
        """Return the world-frame velocity of a control, (2, 1)."""
        return _turned(velocity, float(state[2, 0]))

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """Return the control that produces a world-frame velocity, (2, 1)."""
        return _turned(velocity_xy, -float(state[2, 0]))

    def compute_max_speed(self, vel_max: Floats) -> float:
        """Return the speed at the upper limits of both velocity components [m/s]."""
        return float(np.hypot(*np.asarray(vel_max, dtype=np.float64).reshape(-1)[:2]))

    def compute_heading(self, state: Floats, velocity: Floats) -> float:
        """Return the direction of travel [rad], not wrapped."""
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
        """Return the state after one time step, (3, 1)."""
        return omni_angular_kinematics(state, velocity, step_time, self.noise, self.alpha, self.integration)

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """Return the control that produces a world-frame velocity without rotation, (3, 1)."""
        return np.vstack([_turned(velocity_xy, -float(state[2, 0])), [[0.0]]])

    def compute_heading(self, state: Floats, velocity: Floats) -> float:
        """Return the heading of the body [rad]."""
        return float(state[2, 0])


class PassiveKinematics(KinematicsHandler):
    """An object without a drive: it keeps its world-frame velocity (vx, vy, yaw rate) and friction slows it down."""

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
        """Return the color of an object whose scenario entry has no color."""
        return PUSHABLE_COLOR if pushable else OBSTACLE_COLOR

    def step(self, state: Floats, velocity: Floats, step_time: float) -> Floats:
        """Return the state after one time step, (3, 1)."""
        moved = np.array(state, dtype=np.float64)
        moved[:3, 0] += np.asarray(velocity, dtype=np.float64).reshape(-1)[:3] * step_time
        return moved

    def coast(
        self, velocity: Floats, step_time: float, friction: float, gyration: float = 0.0, gravity: float = 9.81
    ) -> Floats:
        """Return the velocity of the next step, (3, 1): friction with the ground slows it down, at most to rest."""
        after = np.array(velocity, dtype=np.float64).reshape(-1, 1)
        loss = friction * gravity * step_time
        speed, rate = float(np.hypot(after[0, 0], after[1, 0])), abs(float(after[2, 0]))
        after[:2] *= max(0.0, speed - loss) / speed if speed > _FRICTION_STOP else 0.0
        if gyration > 0:
            after[2] *= max(0.0, rate - loss / gyration) / rate if rate > _FRICTION_STOP else 0.0
        return after

    def velocity_to_xy(self, state: Floats, velocity: Floats) -> Floats:
        """Return the world-frame velocity, (2, 1), which is the velocity itself."""
        return np.asarray(velocity, dtype=np.float64).reshape(-1, 1)[:2]

    def velocity_from_xy(self, state: Floats, velocity_xy: Floats) -> Floats:
        """Return the same velocity without rotation, (3, 1)."""
        return np.vstack([np.asarray(velocity_xy, dtype=np.float64).reshape(-1, 1)[:2], [[0.0]]])

    def compute_max_speed(self, vel_max: Floats) -> float:
        """Return 0, because there is no drive."""
        return 0.0


def _turned(vector: Floats, angle: float) -> Floats:
    """Return the first two numbers, rotated, (2, 1)."""
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
    """Creates handlers by the name of the drive."""

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
        """Create the handler of a drive.

        Args:
            name: Name of the drive; None means ``diff``.
            noise: Whether motion noise is on.
            alpha: Parameters of the noise.
            mode: Mode of ``acker``.
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
            why = "has no class for scripts" if KINEMATICS.get(key) is not None else "is not registered"
            raise NotImplementedError(f"kinematics {name!r} {why}")
        if key == "acker":
            kwargs |= {"mode": mode or "steer", "wheelbase": wheelbase or shape_wheelbase or 1.0}
        elif key not in _BUILT_IN:
            kwargs |= {k: v for k, v in (("mode", mode), ("wheelbase", wheelbase)) if v is not None}
        handler: KinematicsHandler = maker(key, noise, alpha, **kwargs)
        handler.tau = tau
        return handler

    @staticmethod
    def get_handler_class(name: str) -> type[KinematicsHandler] | None:
        """Return the class of a drive, or None if no such drive exists."""
        return _BUILT_IN.get(name.lower()) or handler_class(name.lower())
