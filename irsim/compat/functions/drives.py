"""Motion of each drive over one period, for NumPy columns; the core computes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

import irsim._core as core
from irsim.common.arrays import Floats
from irsim.simulation.active_env import current_rng

__all__ = [
    "ackermann_kinematics",
    "differential_kinematics",
    "kinematics_factory",
    "omni_angular_kinematics",
    "omni_kinematics",
]

_INTEGRATIONS = {"euler": 0, "exact": 1}
_DEFAULT_ALPHA = [0.03, 0.0, 0.0, 0.03]
"""Default noise coefficients of differential and Ackermann drives."""


def differential_kinematics(
    state: Floats,
    velocity: Floats,
    step_time: float,
    noise: bool = False,
    alpha: Sequence[float] | None = None,
    integration: str = "euler",
) -> Floats:
    """Move a differential drive by one period.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad]; further rows are ignored.
        velocity: (2 or more, 1) forward speed [m/s], yaw rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Four coefficients of the variances of the noise.
        integration: ``euler``, or ``exact`` for the arc of the velocity, as ``world.integration``.

    Returns:
        (3, 1) next state, heading in [-pi, pi).

    Raises:
        TypeError: An argument is not an array.
        ValueError: An array has too few rows, or the integration is unknown.
    """
    _check(state=(state, 3), velocity=(velocity, 2))
    drive = core.DiffOptions(noise=False, alpha=_alpha(alpha, _DEFAULT_ALPHA, noise), track=1.0)
    return _move(drive, state[:3], velocity[:2], step_time, noise, integration)


def ackermann_kinematics(
    state: Floats,
    velocity: Floats,
    step_time: float,
    noise: bool = False,
    alpha: Sequence[float] | None = None,
    mode: str = "steer",
    wheelbase: float = 1,
    integration: str = "euler",
) -> Floats:
    """Move a car-like (Ackermann) drive by one period.

    Args:
        state: (4 or more, 1) x, y [m] of the rear axle, heading [rad], steering angle [rad].
        velocity: (2 or more, 1) forward speed [m/s] and steering angle [rad], or its rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Four coefficients of the variances of the noise.
        mode: ``steer`` takes a steering angle as the second control, ``angular`` its rate.
        wheelbase: Distance between the axles [m].
        integration: ``euler``, or ``exact`` for the arc of the velocity, as ``world.integration``.

    Returns:
        (4, 1) next state.

    Raises:
        TypeError: An argument is not an array.
        ValueError: An array has too few rows, or the mode or the integration is unknown.
    """
    _check(state=(state, 4), velocity=(velocity, 2))
    if mode not in ("steer", "angular"):
        raise ValueError(f"unknown mode {mode!r}: choose steer or angular")
    coefficients = _alpha(alpha, _DEFAULT_ALPHA, noise)
    drive = core.AckerOptions(
        noise=False, alpha=coefficients, mode=mode, wheelbase=float(wheelbase), psi_max=float("inf")
    )
    return _move(drive, state[:4], velocity[:2], step_time, noise, integration)


def omni_kinematics(
    state: Floats, velocity: Floats, step_time: float, noise: bool = False, alpha: Sequence[float] | None = None
) -> Floats:
    """Move a holonomic drive with a fixed heading by one period.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad].
        velocity: (2 or more, 1) forward and lateral speed [m/s], body frame.
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Variance of the noise of each of the two velocities.

    Returns:
        (3, 1) next state.

    Raises:
        TypeError: An argument is not an array.
        ValueError: An array has too few rows.
    """
    _check(state=(state, 3), velocity=(velocity, 2))
    drive = core.OmniOptions(noise=False, alpha=_alpha(alpha, [0.03] * 2, noise))
    return _move(drive, state[:3], velocity[:2], step_time, noise, "euler")


def omni_angular_kinematics(
    state: Floats,
    velocity: Floats,
    step_time: float,
    noise: bool = False,
    alpha: Sequence[float] | None = None,
    integration: str = "euler",
) -> Floats:
    """Move a holonomic drive that can also turn by one period.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad].
        velocity: (3 or more, 1) forward and lateral speed [m/s], body frame, and yaw rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Variance of the noise of each of the three velocities.
        integration: ``euler``, or ``exact`` for the arc of the velocity, as ``world.integration``.

    Returns:
        (3, 1) next state.

    Raises:
        TypeError: An argument is not an array.
        ValueError: An array has too few rows, or the integration is unknown.
    """
    _check(state=(state, 3), velocity=(velocity, 3))
    drive = core.OmniAngularOptions(noise=False, alpha=_alpha(alpha, [0.03] * 3, noise))
    return _move(drive, state[:3], velocity[:3], step_time, noise, integration)


def _check(**arrays: tuple[Any, int]) -> None:
    for name, (array, rows) in arrays.items():
        if not isinstance(array, np.ndarray):
            raise TypeError(f"{name} must be an array, got {type(array).__name__}")
        if array.shape[0] < rows:
            raise ValueError(f"{name} must have at least {rows} rows, got {array.shape[0]}")


def _alpha(given: Sequence[float] | None, default: list[float], noise: bool) -> list[float]:
    if given is None or not noise:
        return default
    if len(given) < len(default):
        raise ValueError(f"with noise, alpha must have at least {len(default)} numbers, got {len(given)}")
    return [float(value) for value in given[: len(default)]]


def _move(drive: Any, state: Floats, velocity: Floats, step_time: float, noise: bool, integration: str) -> Floats:
    if integration not in _INTEGRATIONS:
        raise ValueError(f"unknown integration {integration!r}: choose euler or exact")
    control = np.asarray(velocity, dtype=np.float64).reshape(-1)
    if noise:
        sigma = np.array(core.drive_deviation(drive, control.tolist()))[: control.size]
        control = control + current_rng().normal(0.0, sigma)
    before = np.asarray(state, dtype=np.float64).reshape(-1).tolist()
    after, _ = core.drive_step(drive, before, control.tolist(), step_time, _INTEGRATIONS[integration])
    return np.array(after)[:, None]


kinematics_factory: dict[str, Any] = {
    "diff": differential_kinematics,
    "acker": ackermann_kinematics,
    "omni": omni_kinematics,
}
"""Name of a drive -> its function."""
