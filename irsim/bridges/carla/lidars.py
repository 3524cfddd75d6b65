"""Lidars of CARLA on actors: they are attached, their frames are waited for, and become scans."""

from __future__ import annotations

import math
import queue
import time
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeLostError
from irsim.bridges.carla.actors import Spawner
from irsim.bridges.carla.roles import Role
from irsim.bridges.carla.scans import scan_of_points, usual_points
from irsim.common.arrays import Floats
from irsim.components.bridges.carla import CarlaLidar
from irsim.simulation.scene import Lidar

__all__ = ["AttachedLidar", "attach_lidars"]

_MAX_FRAMES = 64
"""Number of frames that wait at most; a server that is ticked by others goes on while irsim computes."""
_MARGIN = 0.05
"""Points inside of the box of their own carrier, and this near to it [m], are the carrier."""


class AttachedLidar:
    """A lidar of CARLA that stands for one of the scenario.

    Args:
        sensor: The actor.
        lidar: The lidar of the scenario.
        options: The options.
        count: Points of a channel in a full turn.
        mount: x, y [m], yaw [rad] on the carrier, frame of irsim, from the middle of the carrier.
        half: Half the length and half the width of the carrier [m].

    Attributes:
        yaw: Direction on the carrier [rad], counterclockwise.
    """

    def __init__(
        self, sensor: Any, lidar: Lidar, options: CarlaLidar, count: int,
        mount: tuple[float, float, float], half: tuple[float, float],
    ) -> None:  # fmt: skip
        self.sensor, self.lidar, self.options = sensor, lidar, options
        self.yaw = mount[2]
        self._count, self._mount, self._half = count, mount, half
        self._frames: queue.SimpleQueue[Any] = queue.SimpleQueue()
        sensor.listen(self._keep)

    def _keep(self, measured: Any) -> None:
        """Called by the client with each frame, in a thread of its own."""
        if self._frames.qsize() >= _MAX_FRAMES:
            with suppress(queue.Empty):
                self._frames.get_nowait()
        self._frames.put(measured)

    def scan(self, frame: int, timeout: float, yaw: float | None = None) -> NDArray[np.float32]:
        """(beams,) ranges of a tick [m], infinite for a beam that hit nothing.

        Args:
            frame: The tick.
            timeout: Time to wait for its points [s].
            yaw: Where the lidar should look to, frame of CARLA [deg]: a walker looks where it walks, its object
                where it will. None is where it looks.

        Raises:
            BridgeLostError: No such frame came in time.
        """
        deadline = time.monotonic() + timeout
        while True:
            try:
                measured = self._frames.get(timeout=max(0.0, deadline - time.monotonic()))
            except queue.Empty:
                what = f"the CARLA server sent no points of the lidar {self.lidar.key} within {timeout:g} s"
                raise BridgeLostError(what) from None
            if measured.frame >= frame:
                break
        points = np.frombuffer(measured.raw_data, dtype="<f4").reshape(-1, 4).astype(np.float64)
        points = self._of_others(points)
        if yaw is not None:
            turn = math.radians(measured.transform.rotation.yaw - yaw)
            points[:, :2] = points[:, :2] @ np.array(
                [[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]]
            )
        height = self.options.height
        low, high = self.options.low - height, self.options.high - height
        return scan_of_points(points, self.lidar, self._count, low, high).astype(np.float32)

    def _of_others(self, points: Floats) -> Floats:
        """The points that are not of the carrier itself."""
        x, y, yaw = self._mount
        ahead = x + points[:, 0] * math.cos(yaw) + points[:, 1] * math.sin(yaw)
        left = y + points[:, 0] * math.sin(yaw) - points[:, 1] * math.cos(yaw)
        own = (np.abs(ahead) < self._half[0] + _MARGIN) & (np.abs(left) < self._half[1] + _MARGIN)
        return points[~own]

    def stop(self) -> None:
        """Listen no more."""
        self.sensor.stop()


def attach_lidars(
    carla: Any, spawner: Spawner, role: Role, actor: Any, lift: float, options: CarlaLidar, tick: float
) -> list[AttachedLidar]:
    """Put the lidars of an object on its actor; each makes a full turn in every tick.

    Args:
        carla: The module.
        spawner: Spawns them.
        role: The object.
        actor: Its actor.
        lift: Height of the origin of the actor above the ground [m].
        options: The options.
        tick: Period of CARLA [s].
    """
    found = []
    for lidar in role.lidars:
        count = options.points or usual_points(lidar)
        attributes = {
            "role_name": lidar.key,
            "channels": str(options.channels),
            "range": f"{lidar.range_max + 1.0:g}",
            "points_per_second": str(round(count * options.channels / tick)),
            "rotation_frequency": f"{1 / tick:.9g}",
            "upper_fov": f"{options.upper:g}",
            "lower_fov": f"{options.lower if options.channels > 1 else options.upper:g}",
        }
        if not options.dropoff:
            attributes |= {"dropoff_general_rate": "0.0", "dropoff_zero_intensity": "0.0", "noise_stddev": "0.0"}
        x, y, yaw = lidar.mount[0] - role.ahead, lidar.mount[1], lidar.mount[2]
        at = carla.Transform(
            carla.Location(x=x, y=-y, z=options.height - lift),
            carla.Rotation(pitch=0.0, yaw=-math.degrees(yaw), roll=0.0),
        )
        sensor = spawner.attach(spawner.blueprint("sensor.lidar.ray_cast", 0, attributes), at, actor)
        extent = actor.bounding_box.extent
        half = float(extent.x), float(extent.y)
        found.append(AttachedLidar(sensor, lidar, options, count, (x, y, yaw), half))
    return found
