"""The file beside an imported map that says where the map is in the world it was made from.

A map ``flat.yaml`` has ``flat.bridge.json``. With it, poses of irsim go back to the scene: cameras, exports of runs
and other simulators use it.

    from irsim.bridges.maps.sidecar import read_sidecar

    sidecar = read_sidecar("flat.yaml")
    points = sidecar.to_scene(poses)           # (N, 3) in the frame and the unit of length of the scene
    matrices = sidecar.scene_poses(poses)      # (N, 4, 4) poses whose axes follow the convention of that frame
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from irsim.bridges.base import BridgeError
from irsim.bridges.frames import FRAMES, axes_of, inverse, pose_matrix, rotation_of
from irsim.common.arrays import Floats
from irsim.common.installed import version
from irsim.common.records import ContentError, read_json

__all__ = ["FORMAT", "VERSION", "MapSidecar", "read_sidecar", "scene_transform", "sidecar_path"]

FORMAT = "irsim-map"
"""Value of the key ``format`` in such a file."""
VERSION = 1
"""Version of the file; a reader refuses later ones."""
SUFFIX = ".bridge.json"
_MAX_BYTES = 1 << 20
_LARGEST = 1e12
"""Largest number of a transform."""
_SMALLEST_SCALE = 1e-9
"""Smallest factor between the units of length of the two frames that is not an error."""


@dataclass(frozen=True)
class MapSidecar:
    """Where an imported map is in the world that it was made from.

    Attributes:
        T_scene_from_irsim: (4, 4) maps homogeneous points (x, y, z, 1) of irsim [m], z above the floor, to the frame
            and the unit of length of the scene.
        frame: Convention of the scene's axes, see :mod:`irsim.bridges.frames`.
        floor_height: Height of the chosen floor along the upward axis of the upright scene [m].
        resolution: Side of a cell [m].
        origin: x, y of the lower left corner of the map [m], frame of irsim.
        size: Number of cells along x and y.
        source: ``file`` (its name), ``kind``, ``bytes`` and ``sha256`` of the file that the map was made from.
        agent: The robot that the map was made for: ``headroom``, ``climb``, ``radius`` [m] and ``slope`` [deg].
        level: Number of the level, counted from the lowest.
        unknown: Whether unknown cells are ``free``, ``occupied`` or ``unknown`` in the scenario.
        irsim: Version of irsim that made the map.
    """

    T_scene_from_irsim: Floats
    frame: str
    floor_height: float = 0.0
    resolution: float = 0.05
    origin: tuple[float, float] = (0.0, 0.0)
    size: tuple[int, int] = (0, 0)
    source: dict[str, Any] = field(default_factory=dict)
    agent: dict[str, float] = field(default_factory=dict)
    level: int = 0
    unknown: str = "occupied"
    irsim: str = field(default_factory=version)

    @property
    def scale(self) -> float:
        """Units of length of the scene in a metre."""
        return float(np.cbrt(abs(np.linalg.det(self.T_scene_from_irsim[:3, :3]))))

    @property
    def transform(self) -> Floats:
        """(4, 4) what remains of ``T_scene_from_irsim`` without the axes of the frame.

        It is the argument ``transform`` of :func:`irsim.bridges.frames.to_frame` and ``camera_pose``; it is rigid only
        where the scene is in metres.
        """
        axes = np.eye(4)
        axes[:3, :3] = axes_of(self.frame)
        result: Floats = self.T_scene_from_irsim @ axes.T
        return result

    def to_scene(self, poses: Floats, height: float = 0.0) -> Floats:
        """Positions in the frame of the scene.

        Args:
            poses: (N, 2) or (N, 3) x, y [m] and perhaps yaw [rad], frame of irsim.
            height: Height above the floor [m].

        Returns:
            (N, 3) points in the unit of length of the scene.
        """
        poses = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        points = np.column_stack([poses[:, :2], np.full(len(poses), height), np.ones(len(poses))])
        result: Floats = (points @ self.T_scene_from_irsim.T)[:, :3]
        return result

    def scene_poses(self, poses: Floats, height: float = 0.0) -> Floats:
        """Poses in the frame of the scene.

        Args:
            poses: (N, 3) x, y [m], yaw [rad], frame of irsim.
            height: Height above the floor [m].

        Returns:
            (N, 4, 4) rigid transforms: positions in the unit of length of the scene; the axes of the body follow the
            convention of the frame (in a frame with y up, the body's y points up as well).
        """
        poses = np.atleast_2d(np.asarray(poses, dtype=np.float64))
        turn = self.T_scene_from_irsim[:3, :3] / self.scale
        result = np.zeros((len(poses), 4, 4))
        result[:, :3, :3] = turn @ rotation_of(poses[:, 2]) @ axes_of(self.frame).T
        result[:, :3, 3] = self.to_scene(poses, height)
        result[:, 3, 3] = 1.0
        return result

    def to_irsim(self, points: Floats) -> Floats:
        """The inverse of :meth:`to_scene`: (N, 3) x, y and height above the floor [m] of points (N, 3) of the scene."""
        points = np.atleast_2d(np.asarray(points, dtype=np.float64))
        result: Floats = (np.column_stack([points, np.ones(len(points))]) @ inverse(self.T_scene_from_irsim).T)[:, :3]
        return result

    def as_json(self) -> str:
        """The text of the file."""
        content = {
            "format": FORMAT,
            "version": VERSION,
            "irsim": self.irsim,
            "source": self.source,
            "frame": self.frame,
            "T_scene_from_irsim": np.asarray(self.T_scene_from_irsim).tolist(),
            "floor_height": self.floor_height,
            "level": self.level,
            "resolution": self.resolution,
            "origin": list(self.origin),
            "size": list(self.size),
            "agent": self.agent,
            "unknown": self.unknown,
        }
        return json.dumps(content, indent=2, allow_nan=False) + "\n"


def scene_transform(
    frame: str, floor_height: float = 0.0, meters_per_unit: float = 1.0, turn: Floats | None = None
) -> Floats:
    """``T_scene_from_irsim`` of a map that keeps the horizontal coordinates of its scene, once that is upright.

    Args:
        frame: Convention of the scene's axes.
        floor_height: Height of the floor along the scene's upward axis [m].
        meters_per_unit: Length of a unit of the scene [m].
        turn: (3, 3) rotation in the frame of the scene that makes it upright; None if it stands upright.

    Returns:
        (4, 4) matrix of points.
    """
    axes = np.eye(4)
    axes[:3, :3] = axes_of(frame) / meters_per_unit
    if turn is not None:
        axes[:3, :3] = turn.T @ axes[:3, :3]
    result: Floats = axes @ pose_matrix(np.zeros(3), floor_height)
    return result


def sidecar_path(scenario: str | Path) -> Path:
    """The file beside a scenario: ``flat.bridge.json`` for ``flat.yaml``."""
    return Path(scenario).with_suffix(SUFFIX)


def read_sidecar(file: str | Path) -> MapSidecar:
    """The sidecar of a map.

    Args:
        file: The sidecar, or the scenario that it belongs to.

    Raises:
        BridgeError: The file cannot be read, or has wrong values; the message says which.
    """
    path = Path(file)
    path = path if path.name.endswith(".json") else sidecar_path(path)
    try:
        content = read_json(path, most_bytes=_MAX_BYTES)
    except ContentError as error:
        raise _wrong(path, f"it cannot be read: {error.message}") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise _wrong(path, f"its key 'format' is not '{FORMAT}'")
    if content.get("version") != VERSION:
        raise _wrong(path, f"its key 'version' is {content.get('version')!r}, and this irsim reads {VERSION}")
    return _checked(path, content)


def _checked(path: Path, content: dict[str, Any]) -> MapSidecar:
    matrix = _matrix(path, content.get("T_scene_from_irsim"))
    if content.get("frame") not in FRAMES:
        raise _wrong(path, f"its key 'frame' is not one of {', '.join(FRAMES)}")
    tables = [content.get(key, {}) for key in ("source", "agent")]
    if not all(isinstance(table, dict) for table in tables):
        raise _wrong(path, "its keys 'source' and 'agent' must be mappings")
    origin = _numbers(path, content, "origin", 2)
    size = _numbers(path, content, "size", 2)
    return MapSidecar(
        T_scene_from_irsim=matrix,
        frame=content["frame"],
        floor_height=_numbers(path, {"floor_height": [content.get("floor_height", 0.0)]}, "floor_height", 1)[0],
        resolution=_numbers(path, {"resolution": [content.get("resolution")]}, "resolution", 1)[0],
        origin=(origin[0], origin[1]),
        size=(int(size[0]), int(size[1])),
        source=tables[0],
        agent=tables[1],
        level=int(_numbers(path, {"level": [content.get("level", 0)]}, "level", 1)[0]),
        unknown=str(content.get("unknown", "occupied")),
        irsim=str(content.get("irsim", "")),
    )


def _matrix(path: Path, value: Any) -> Floats:
    """The transform: finite, invertible, the same scale along each axis."""
    try:
        matrix = np.array(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        matrix = np.zeros(0)
    finite = bool((np.abs(matrix) <= _LARGEST).all())  # false for what is not a number, too
    if matrix.shape != (4, 4) or not finite or (matrix[3] != [0, 0, 0, 1]).any():
        raise _wrong(path, "its key 'T_scene_from_irsim' must be a 4x4 matrix of numbers whose last row is 0, 0, 0, 1")
    squares = matrix[:3, :3].T @ matrix[:3, :3]
    scale = float(squares[0, 0])
    if scale < _SMALLEST_SCALE**2 or not np.allclose(squares / scale, np.eye(3), atol=1e-6):
        raise _wrong(path, "its key 'T_scene_from_irsim' must turn, shift and scale evenly")
    return matrix


def _numbers(path: Path, content: dict[str, Any], key: str, count: int) -> list[float]:
    values = content.get(key)
    good = isinstance(values, list) and len(values) == count
    if not good or not all(type(value) in (int, float) and math.isfinite(value) for value in values or ()):
        raise _wrong(path, f"its key '{key}' must be {'a number' if count == 1 else f'{count} numbers'}")
    return [float(value) for value in values or ()]


def _wrong(path: Path, why: str) -> BridgeError:
    return BridgeError("bridge-file", f"{path} is not the sidecar of a map: {why}", "import the map again")
