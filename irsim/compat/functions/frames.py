"""Angles, distances, velocities and frames, with the function names of IR-SIM 2.12."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from irsim.common.angles import FULL_TURN, wrap
from irsim.common.arrays import Floats

__all__ = [
    "ClipTo2Pi",
    "WrapTo2Pi",
    "WrapToPi",
    "WrapToRegion",
    "diff_to_omni",
    "dist_hypot",
    "distance",
    "get_affine_transform",
    "get_transform",
    "omni_to_diff",
    "relative_position",
    "transform_point_with_state",
    "vel_diff2world",
    "vel_omni2world",
    "vel_world2diff",
    "vel_world2omni",
    "vertices_transform",
]


_INTERVAL_NUMBERS = 2


def _flat(values: Any) -> Floats:
    if values is None:
        raise TypeError("None is neither a point nor a pose nor a velocity")
    return np.asarray(values, dtype=np.float64).reshape(-1)


def WrapToPi(rad: float, positive: bool = False) -> float:
    """Wrap an angle to [-pi, pi); ``positive`` returns its absolute value. A value that is not finite becomes 0."""
    if not math.isfinite(rad):
        return 0.0
    wrapped = wrap(float(rad))
    return abs(wrapped) if positive else wrapped


def WrapTo2Pi(rad: float) -> float:
    """Wrap an angle to [0, 2 pi). A value that is not finite becomes 0."""
    return wrap(float(rad), 0.0) if math.isfinite(rad) else 0.0


def ClipTo2Pi(rad: float) -> float:
    """Clip a number to [0, 2 pi]. NaN becomes 0."""
    return 0.0 if math.isnan(rad) else min(max(float(rad), 0.0), FULL_TURN)


def WrapToRegion(rad: float, range: list[float]) -> float:
    """Wrap an angle to an interval whose width is one full turn; an angle that lies in it, at either end, stays.

    Angles above the interval come to lie in (low, high], angles below it in [low, high).

    Raises:
        ValueError: ``range`` has fewer than two numbers.
        AssertionError: The width of ``range`` is not 2 pi.
    """
    if len(range) < _INTERVAL_NUMBERS:
        raise ValueError(f"an interval of angles has two numbers, got {range!r}")
    low, high = float(range[0]), float(range[1])
    assert math.isclose(high - low, FULL_TURN), f"an interval of angles must be 2 pi wide, got {high - low}"
    angle = float(rad)
    if low <= angle <= high:
        return angle
    wrapped = wrap(angle, low)
    return high if angle > high and wrapped == low else wrapped


def relative_position(position1: Any, position2: Any, topi: bool = True) -> tuple[float, float]:
    """Return distance [m] and bearing [rad] of the second point as seen from the first.

    ``topi`` wraps the bearing to [-pi, pi); without it, pi itself is possible.
    """
    dx, dy = (_flat(position2)[:2] - _flat(position1)[:2]).tolist()
    bearing = math.atan2(dy, dx)
    return math.hypot(dx, dy), WrapToPi(bearing) if topi else bearing


def distance(point1: Any, point2: Any) -> float:
    """Return the distance between two points in the plane [m]."""
    a, b = _flat(point1), _flat(point2)
    return math.hypot(a[0] - b[0], a[1] - b[1])


def dist_hypot(x1: float, y1: float, x2: float, y2: float) -> float:
    """Return the distance between two points in the plane, given by their coordinates [m]."""
    return math.hypot(x1 - x2, y1 - y2)


def vel_world2diff(
    state_ori: float,
    vel_omni: Any,
    w_max: float = 1.5,
    guarantee_time: float = 0.2,
    tolerance: float = 0.1,
    mini_speed: float = 0.02,
) -> Floats:
    """Return the control with which a differential drive follows a world-frame velocity.

    The drive turns towards the velocity and moves with its forward component, never backwards.

    Args:
        state_ori: Heading [rad].
        vel_omni: vx, vy [m/s], world frame.
        w_max: Highest yaw rate [rad/s].
        guarantee_time: Time that the turn takes unless ``w_max`` limits it [s].
        tolerance: Smaller differences of heading [rad] are ignored.
        mini_speed: A lower wanted speed [m/s] gives a control of zero.

    Returns:
        (2, 1) forward speed [m/s] and yaw rate [rad/s].
    """
    vx, vy = _flat(vel_omni)[:2].tolist()
    speed = math.hypot(vx, vy)
    if speed < mini_speed:
        return np.zeros((2, 1))
    off = WrapToPi(state_ori - math.atan2(vy, vx))
    rate = 0.0 if abs(off) < tolerance else min(max(-off / guarantee_time, -w_max), w_max)
    return np.array([[max(0.0, speed * math.cos(off))], [rate]])


omni_to_diff = vel_world2diff


def vel_diff2world(state_ori: float, vel_diff: Any) -> Floats:
    """Return the (2, 1) world-frame velocity [m/s] of a forward speed at a heading [rad].

    An array without dimensions, such as ``np.array(None)``, stands for no control, and gives zero.
    """
    if isinstance(vel_diff, np.ndarray) and vel_diff.ndim == 0:
        return np.zeros((2, 1))
    speed = float(_flat(vel_diff)[0])
    return np.array([[speed * math.cos(state_ori)], [speed * math.sin(state_ori)]])


diff_to_omni = vel_diff2world


def vel_world2omni(state_ori: float, vel_world: Any) -> Floats:
    """Return the (2, 1) forward and lateral velocity [m/s] of a world-frame velocity at a heading [rad]."""
    return _rotation(-state_ori) @ _flat(vel_world)[:2, None]


def vel_omni2world(state_ori: float, vel_body: Any) -> Floats:
    """Return the (2, 1) world-frame velocity [m/s] of a forward and lateral velocity at a heading [rad]."""
    return _rotation(state_ori) @ _flat(vel_body)[:2, None]


def _rotation(angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s], [s, c]])


def get_transform(state: Any) -> tuple[Floats, Floats]:
    """Return the translation (2, 1) and rotation (2, 2) of a pose; a pose without a heading is not rotated."""
    pose = _flat(state)
    return pose[:2, None], _rotation(pose[2]) if pose.size > 2 else np.eye(2)


def get_affine_transform(state: Any) -> list[float]:
    """Return a pose as the list [a, b, d, e, x, y] of :func:`shapely.affinity.affine_transform`."""
    (x, y), rotation = _flat(state)[:2].tolist(), get_transform(state)[1]
    return [*rotation.reshape(-1).tolist(), x, y]


def transform_point_with_state(point: Any, state: Any) -> Floats:
    """Transform a pose from the frame of ``state`` to the world frame: (3, 1), heading in [-pi, pi)."""
    inner, outer = _flat(point), _flat(state)
    translation, rotation = get_transform(outer)
    x, y = (rotation @ inner[:2, None] + translation)[:, 0].tolist()
    return np.array([[x], [y], [WrapToPi(float(inner[2] + outer[2]))]])


def vertices_transform(vertices: Any, state: Any) -> Floats | None:
    """Transform (2, N) points from the body frame at a pose to the world frame; None without points or a pose."""
    if vertices is None or state is None:
        return None
    translation, rotation = get_transform(state)
    moved: Floats = rotation @ np.asarray(vertices, dtype=np.float64) + translation
    return moved
