"""Frames of other programs: where a pose of the plane of irsim is in theirs.

irsim and ROS (REP-103) are right-handed, x forward, y to the left, z up, yaw counterclockwise in radians. Every other
convention is a linear map of axes, so that one matrix says all: its columns are the axes of irsim in the other frame.
A yaw turns the body, whose own axes follow the same convention.

- ``carla``: left-handed, x forward, y to the **right**, z up, yaw clockwise seen from above
- ``usd``: a stage with ``upAxis`` Z; ``usd_yup`` is one with ``upAxis`` Y
- ``habitat_yup``, ``gltf``: x to the right, y up, z to the back: y of irsim is -z
- ``colmap``: x to the right, y **down**, z forward: a world with the axes of its first camera

Cameras have axes of their own. In ``opengl`` a camera looks along -z, with x to its right and y up; in ``colmap`` it
looks along z, with x to its right and y down.
"""

from __future__ import annotations

import math
from typing import Literal, TypeAlias, get_args

import numpy as np

from irsim.common.arrays import Floats
from irsim.diagnostics.diagnostic import suggestion
from irsim.diagnostics.errors import ArgumentError

__all__ = [
    "CAMERA_AXES",
    "FRAMES",
    "FrameName",
    "angles_of",
    "axes_of",
    "camera_pose",
    "inverse",
    "planar_pose",
    "pose_matrix",
    "quaternion_of",
    "rotation_of",
    "to_frame",
    "to_irsim",
    "turn_between",
    "turn_of",
    "yaw_of",
]

FrameName: TypeAlias = Literal["irsim", "ros", "carla", "usd", "usd_yup", "habitat_yup", "gltf", "colmap"]
FRAMES: tuple[str, ...] = get_args(FrameName)
"""Names of the frames of worlds."""

_Z_UP: Floats = np.eye(3)
_Y_UP: Floats = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
_Y_RIGHT: Floats = np.diag([1.0, -1.0, 1.0])
CAMERA_AXES: dict[str, Floats] = {
    "opengl": np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "colmap": np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]),
}
"""Axes of a camera that looks forward, in the body frame of irsim: columns are its x, y and z."""


def axes_of(frame: str) -> Floats:
    """(3, 3) the axes of irsim in another frame, as columns; -1 is the determinant of a left-handed frame.

    Raises:
        ArgumentError: There is no such frame.
    """
    if frame in ("irsim", "ros", "usd"):
        return _Z_UP.copy()
    if frame in ("usd_yup", "habitat_yup", "gltf"):
        return _Y_UP.copy()
    if frame == "colmap":
        return CAMERA_AXES["colmap"].T.copy()
    if frame == "carla":
        return _Y_RIGHT.copy()
    raise ArgumentError(f"{frame!r} is not a frame", suggestion(frame, FRAMES, f"frames are {', '.join(FRAMES)}"))


def rotation_of(yaw: Floats | float) -> Floats:
    """(..., 3, 3) rotation about z by a yaw [rad]."""
    angle = np.asarray(yaw, dtype=np.float64)
    result = np.zeros((*angle.shape, 3, 3))
    result[..., 0, 0] = result[..., 1, 1] = np.cos(angle)
    result[..., 1, 0] = np.sin(angle)
    result[..., 0, 1] = -result[..., 1, 0]
    result[..., 2, 2] = 1.0
    return result


def turn_of(roll: float, pitch: float, yaw: float) -> Floats:
    """(3, 3) rotation about x, then y, then z, which stay where they are, by angles [rad], as in SDF and URDF."""
    (a, b, c), (i, j, k) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array([
        [c * b, c * j * i - k * a, c * j * a + k * i],
        [k * b, k * j * i + c * a, k * j * a - c * i],
        [-j, b * i, b * a],
    ])  # fmt: skip


def angles_of(turn: Floats) -> tuple[float, float, float]:
    """Roll, pitch and yaw [rad] of a rotation (3, 3), the inverse of :func:`turn_of`; roll is 0 where it is free."""
    level = math.hypot(turn[0, 0], turn[1, 0])
    pitch = math.atan2(-turn[2, 0], level)
    if level < 1e-9:
        return 0.0, pitch, math.atan2(-turn[0, 1], turn[1, 1])
    return math.atan2(turn[2, 1], turn[2, 2]), pitch, math.atan2(turn[1, 0], turn[0, 0])


def turn_between(start: Floats, end: Floats) -> Floats:
    """(3, 3) the smallest rotation that brings one unit vector (3,) onto another one, less than half a turn away."""
    x, y, z = np.cross(start, end)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    result: Floats = np.eye(3) + cross + cross @ cross / (1.0 + float(start @ end))
    return result


def pose_matrix(pose: Floats, height: float = 0.0) -> Floats:
    """(..., 4, 4) matrices of poses (..., 3) x, y [m], yaw [rad] at a height [m], frame of irsim."""
    pose = np.asarray(pose, dtype=np.float64)
    result = np.zeros((*pose.shape[:-1], 4, 4))
    result[..., :3, :3] = rotation_of(pose[..., 2])
    result[..., :2, 3] = pose[..., :2]
    result[..., 2, 3] = height
    result[..., 3, 3] = 1.0
    return result


def to_frame(matrix: Floats, frame: str, transform: Floats | None = None) -> Floats:
    """Poses of irsim in another frame.

    Args:
        matrix: (..., 4, 4) poses in the frame of irsim.
        frame: Convention of the other frame.
        transform: (4, 4) further transform in the other frame, such as ``T_scene_from_irsim`` of a map without its
            axes: it is applied last.

    Returns:
        (..., 4, 4) poses whose body axes follow the convention of the other frame, too.
    """
    axes = np.eye(4)
    axes[:3, :3] = axes_of(frame)
    result: Floats = axes @ np.asarray(matrix, dtype=np.float64) @ axes.T
    return result if transform is None else np.asarray(transform, dtype=np.float64) @ result


def to_irsim(matrix: Floats, frame: str, transform: Floats | None = None) -> Floats:
    """The inverse of :func:`to_frame`: (..., 4, 4) poses of another frame in the frame of irsim."""
    matrix = np.asarray(matrix, dtype=np.float64)
    if transform is not None:
        matrix = inverse(transform) @ matrix
    axes = np.eye(4)
    axes[:3, :3] = axes_of(frame)
    result: Floats = axes.T @ matrix @ axes
    return result


def inverse(matrix: Floats) -> Floats:
    """(..., 4, 4) inverse of transforms."""
    result: Floats = np.linalg.inv(np.asarray(matrix, dtype=np.float64))
    return result


def yaw_of(matrix: Floats) -> Floats:
    """(...) yaw [rad] of poses (..., 4, 4) in the frame of irsim: the direction of their x axis, seen from above."""
    matrix = np.asarray(matrix, dtype=np.float64)
    result: Floats = np.arctan2(matrix[..., 1, 0], matrix[..., 0, 0])
    return result


def planar_pose(matrix: Floats) -> Floats:
    """(..., 3) x, y [m], yaw [rad] of poses (..., 4, 4) in the frame of irsim."""
    matrix = np.asarray(matrix, dtype=np.float64)
    return np.stack([matrix[..., 0, 3], matrix[..., 1, 3], yaw_of(matrix)], axis=-1)


def camera_pose(
    pose: Floats, axes: str, height: float, frame: str = "irsim", transform: Floats | None = None
) -> Floats:
    """(..., 4, 4) camera-to-world matrices of cameras that look forward from poses (..., 3) of the plane.

    Args:
        pose: x, y [m], yaw [rad], frame of irsim.
        axes: ``opengl`` or ``colmap``, see :data:`CAMERA_AXES`.
        height: Height of the camera above the ground [m].
        frame: Convention of the world in which the cameras are.
        transform: As in :func:`to_frame`.
    """
    turned = np.eye(4)
    turned[:3, :3] = CAMERA_AXES[axes]
    world = np.eye(4)
    world[:3, :3] = axes_of(frame)
    result: Floats = world @ pose_matrix(pose, height) @ turned
    return result if transform is None else np.asarray(transform, dtype=np.float64) @ result


def quaternion_of(rotation: Floats) -> Floats:
    """(..., 4) unit quaternions x, y, z, w with w >= 0 of rotations (..., 3, 3) (Shepperd, 1978)."""
    r = np.asarray(rotation, dtype=np.float64)
    trace = np.trace(r, axis1=-2, axis2=-1)
    squares = np.stack([r[..., 0, 0], r[..., 1, 1], r[..., 2, 2], trace], axis=-1)
    largest = squares.argmax(axis=-1)
    x, y, z = (1 + 2 * squares[..., k] - trace for k in range(3))
    off = {
        "yz": r[..., 2, 1] + r[..., 1, 2], "zx": r[..., 0, 2] + r[..., 2, 0], "xy": r[..., 1, 0] + r[..., 0, 1],
        "x": r[..., 2, 1] - r[..., 1, 2], "y": r[..., 0, 2] - r[..., 2, 0], "z": r[..., 1, 0] - r[..., 0, 1],
    }  # fmt: skip
    choices = np.stack([
        np.stack([x, off["xy"], off["zx"], off["x"]], axis=-1),
        np.stack([off["xy"], y, off["yz"], off["y"]], axis=-1),
        np.stack([off["zx"], off["yz"], z, off["z"]], axis=-1),
        np.stack([off["x"], off["y"], off["z"], 1 + trace], axis=-1),
    ], axis=-2)  # fmt: skip
    chosen = np.take_along_axis(choices, largest[..., None, None], axis=-2)[..., 0, :]
    chosen = chosen / np.linalg.norm(chosen, axis=-1, keepdims=True)
    result: Floats = np.where(chosen[..., 3:] < 0, -chosen, chosen)
    return result
