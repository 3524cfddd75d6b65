"""One period of each drive, for columns of NumPy; the engine computes it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.simulation.active_env import current_rng

__all__ = [
    "ackermann_kinematics",
    "differential_kinematics",
    "kinematics_factory",
    "omni_angular_kinematics",
    "omni_kinematics",
]

Floats = NDArray[np.float64]
_ALPHA = [0.03, 0.0, 0.0, 0.03]


def differential_kinematics(
    state: Floats, velocity: Floats, step_time: float, noise: bool = False, alpha: Sequence[float] | None = None
) -> Floats:
    """Move a differential drive.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad]; surplus rows are ignored.
        velocity: (2 or more, 1) forward speed [m/s], yaw rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Four coefficients of its variances.

    Returns:
        (3, 1) the next state, heading in [-pi, pi).

    Raises:
        TypeError: Not arrays. ValueError: Too few rows.
    """
    _check(state=(state, 3), velocity=(velocity, 2))
    drive = core.DiffOptions(noise=False, alpha=_alpha(alpha, _ALPHA, noise))
    return _moved(drive, state[:3], velocity[:2], step_time, noise)


def ackermann_kinematics(
    state: Floats,
    velocity: Floats,
    step_time: float,
    noise: bool = False,
    alpha: Sequence[float] | None = None,
    mode: str = "steer",
    wheelbase: float = 1,
) -> Floats:
    """Move a car.

    Args:
        state: (4 or more, 1) x, y [m] of the rear axle, heading [rad], steering angle [rad].
        velocity: (2 or more, 1) forward speed [m/s] and steering angle [rad], or its rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Four coefficients of its variances.
        mode: ``steer``: the second control is the angle; ``angular``: its rate.
        wheelbase: Distance of the axles [m].

    Returns:
        (4, 1) the next state.

    Raises:
        TypeError: Not arrays. ValueError: Too few rows, or an unknown mode.
    """
    _check(state=(state, 4), velocity=(velocity, 2))
    if mode not in ("steer", "angular"):
        raise ValueError(f"unknown mode {mode!r}: choose steer or angular")
    coefficients = _alpha(alpha, _ALPHA, noise)
    drive = core.AckerOptions(
        noise=False, alpha=coefficients, mode=mode, wheelbase=float(wheelbase), psi_max=float("inf")
    )
    return _moved(drive, state[:4], velocity[:2], step_time, noise)


def omni_kinematics(
    state: Floats, velocity: Floats, step_time: float, noise: bool = False, alpha: Sequence[float] | None = None
) -> Floats:
    """Move a holonomic drive of fixed heading.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad].
        velocity: (2 or more, 1) forward and lateral speed [m/s], body frame.
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Two variances.

    Returns:
        (3, 1) the next state.

    Raises:
        TypeError: Not arrays. ValueError: Too few rows.
    """
    _check(state=(state, 3), velocity=(velocity, 2))
    drive = core.OmniOptions(noise=False, alpha=_alpha(alpha, [0.03] * 2, noise))
    return _moved(drive, state[:3], velocity[:2], step_time, noise)


def omni_angular_kinematics(
    state: Floats, velocity: Floats, step_time: float, noise: bool = False, alpha: Sequence[float] | None = None
) -> Floats:
    """Move a holonomic drive that turns, too.

    Args:
        state: (3 or more, 1) x, y [m], heading [rad].
        velocity: (3 or more, 1) forward and lateral speed [m/s], body frame, and yaw rate [rad/s].
        step_time: Period [s].
        noise: Add Gaussian noise to the velocity.
        alpha: Three variances.

    Returns:
        (3, 1) the next state.

    Raises:
        TypeError: Not arrays. ValueError: Too few rows.
    """
    _check(state=(state, 3), velocity=(velocity, 3))
    drive = core.OmniAngularOptions(noise=False, alpha=_alpha(alpha, [0.03] * 3, noise))
    return _moved(drive, state[:3], velocity[:3], step_time, noise)


def _check(**arrays: tuple[Any, int]) -> None:
    for name, (array, rows) in arrays.items():
        if not isinstance(array, np.ndarray):
            raise TypeError(f"{name} is an array, not {type(array).__name__}")
        if array.shape[0] < rows:
            raise ValueError(f"{name} has at least {rows} rows, not {array.shape[0]}")


def _alpha(given: Sequence[float] | None, default: list[float], noise: bool) -> list[float]:
    if given is None or not noise:
        return default
    if len(given) < len(default):
        raise ValueError(f"alpha has at least {len(default)} numbers when there is noise, not {len(given)}")
    return [float(value) for value in given[: len(default)]]


def _moved(drive: Any, state: Floats, velocity: Floats, step_time: float, noise: bool) -> Floats:
    control = np.asarray(velocity, dtype=np.float64).reshape(-1)
    if noise:
        sigma = np.array(core.drive_deviation(drive, control.tolist()))[: control.size]
        control = control + current_rng().normal(0.0, sigma)
    after, _ = core.drive_step(
        drive, np.asarray(state, dtype=np.float64).reshape(-1).tolist(), control.tolist(), step_time
    )
    return np.array(after)[:, None]


kinematics_factory: dict[str, Any] = {
    "diff": differential_kinematics,
    "acker": ackermann_kinematics,
    "omni": omni_kinematics,
}
"""Drive -> its function."""
