"""Poses of a robot from the transforms of a bag: the chain from the outermost frame to the frame of the scans."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

from irsim.bridges.base import BridgeError
from irsim.bridges.ros.real import composed

__all__ = ["MAX_TRANSFORMS", "Pose", "Transforms"]

Pose = tuple[float, float, float]
MAX_TRANSFORMS = 2_000_000
"""Largest number of transforms of a bag."""


class Transforms:
    """The transforms of a bag in the plane, each from a frame to its parent.

    Attributes:
        fixed: (parent, child) -> pose of the child [m, rad] that does not change.
        moving: (parent, child) -> times [s] and poses, in the order of the bag.
    """

    def __init__(self) -> None:
        self.fixed: dict[tuple[str, str], Pose] = {}
        self.moving: dict[tuple[str, str], list[tuple[float, Pose]]] = {}
        self._count = 0

    def add(self, message: Any, *, fixed: bool) -> None:
        """Add the transforms of a message; transforms that are not finite are left out.

        Raises:
            BridgeError: There are too many.
        """
        for one in message.transforms:
            place, turn = one.transform.translation, one.transform.rotation
            yaw = math.atan2(2 * (turn.w * turn.z + turn.x * turn.y), 1 - 2 * (turn.y**2 + turn.z**2))
            pose = (float(place.x), float(place.y), yaw)
            self._count += 1
            if self._count > MAX_TRANSFORMS:
                what = f"the bag has more than {MAX_TRANSFORMS} transforms"
                raise BridgeError("bridge-file", what, "cut it: ros2 bag convert")
            if not all(map(math.isfinite, pose)):
                continue
            edge = (frame(one.header.frame_id), frame(one.child_frame_id))
            if fixed:
                self.fixed[edge] = pose
            else:
                time = float(one.header.stamp.sec) + float(one.header.stamp.nanosec) / 1e9
                self.moving.setdefault(edge, []).append((time, pose))

    def chain(self, child: str) -> list[tuple[str, str]]:
        """The edges from the outermost frame to a frame; none if no transform leads to it."""
        parents = {edge[1]: edge for edge in (*self.fixed, *self.moving)}
        edges: list[tuple[str, str]] = []
        while child in parents and parents[child] not in edges:
            edges.insert(0, parents[child])
            child = parents[child][0]
        return edges

    def driven(self, scan_frame: str) -> tuple[list[tuple[float, float, float, float]], Pose]:
        """The way of the robot that carries the lidar.

        The robot is the frame behind the last transform of the chain that moves; what follows is the mount.

        Args:
            scan_frame: Frame of the scans.

        Returns:
            Rows of time [s], x, y [m], yaw [rad] in the outermost frame, and the pose of the lidar on the robot.

        Raises:
            BridgeError: No moving transform leads to the frame.
        """
        edges = self.chain(scan_frame)
        last = max((index for index, edge in enumerate(edges) if edge in self.moving), default=None)
        if last is None:
            known = ", ".join(sorted({name for edge in self.moving for name in edge})[:8]) or "none"
            what = f"no moving transform leads to the frame {scan_frame!r} of the scans; frames that move: {known}"
            raise BridgeError("bridge-file", what, "record /tf and /tf_static, or the odometry")
        mount: Pose = (0.0, 0.0, 0.0)
        for edge in edges[last + 1 :]:
            mount = composed(mount, self.fixed[edge])
        for edge in edges[: last + 1]:
            if edge in self.moving:
                self.moving[edge].sort()
        rows = []
        for time, own in self.moving[edges[last]]:
            pose: Pose = (0.0, 0.0, 0.0)
            for edge in edges[:last]:
                pose = composed(pose, self.fixed[edge] if edge in self.fixed else _held(self.moving[edge], time))
            rows.append((time, *composed(pose, own)))
        return rows, mount


def frame(name: Any) -> str:
    """The name of a frame; ROS 1 wrote some with a slash in front."""
    return str(name).lstrip("/")


def _held(known: Sequence[tuple[float, Pose]], time: float) -> Pose:
    """The last pose up to a time: corrections of a localization hold until the next one."""
    after = bisect_right(known, time, key=lambda row: row[0])
    return known[max(0, after - 1)][1]
