"""Lidars of CARLA: what they are made of, and their scans as ranges of irsim."""

from __future__ import annotations

import math
import queue
import time
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeLostError
from irsim.bridges.carla.actors import Role, Spawner
from irsim.common.angles import FULL_TURN, wrap
from irsim.common.arrays import Floats
from irsim.components.bridges.carla import CarlaLidar
from irsim.simulation.scene import Lidar

__all__ = ["AttachedLidar", "attach_lidars", "scan_of_points", "usual_points"]

_STEEP = 10.0
"""Two neighbouring points are of one surface if the gap between them is at most this many times the one that a surface
across the beam has; that is a surface which the beam meets at 6° or more."""


def usual_points(lidar: Lidar) -> int:
    """Points in a full turn for a scan: four for each beam, from 720 to 20,000."""
    opening = abs(lidar.angle_max - lidar.angle_min)
    beams = FULL_TURN / opening * (lidar.beams - 1) if lidar.beams > 1 and opening > 0 else 90.0
    return min(20_000, max(720, math.ceil(4 * beams)))


def scan_of_points(points: Floats, lidar: Lidar, count: int, low: float, high: float) -> Floats:
    """Ranges of the beams of a planar lidar.

    Points outside of the band are left out. Of points above each other the nearest counts. A beam between two points of
    one surface has the range of the straight line through them; one at an edge has the range of the nearer direction.

    Args:
        points: (n, 3 or more) x forward, y to the **right**, z up [m], frame of the sensor.
        lidar: The lidar whose scan is wanted.
        count: Number of points of each channel in a full turn.
        low: Lower end of the band [m], relative to the sensor.
        high: Its upper end [m].

    Returns:
        (beams,) [m], infinite for a beam without a point, or whose point is beyond the longest range.
    """
    points = np.asarray(points, dtype=np.float64)
    kept = points[(points[:, 2] >= low) & (points[:, 2] <= high) & np.isfinite(points).all(axis=1)]
    beams = lidar.angles
    if not len(kept):
        return np.full(len(beams), np.inf)
    step = FULL_TURN / count
    angles, ranges = _nearest_in_columns(np.arctan2(-kept[:, 1], kept[:, 0]), np.hypot(kept[:, 0], kept[:, 1]), step)
    after = np.searchsorted(angles, wrap(beams)) % len(angles)
    before = after - 1
    ahead, behind = _turn(angles[after] - beams), _turn(beams - angles[before])
    near, far = ranges[before], ranges[after]
    gap = np.hypot(far * np.cos(ahead + behind) - near, far * np.sin(ahead + behind))
    reach = step * 1.5
    joined = (ahead <= reach) & (behind <= reach) & (gap <= _STEEP * step * np.maximum(near, far))
    with np.errstate(divide="ignore", invalid="ignore"):
        line = near * far * np.sin(ahead + behind) / (near * np.sin(behind) + far * np.sin(ahead))
    closest = np.where(ahead < behind, far, near)
    alone = np.where(np.minimum(ahead, behind) <= step / 2 * 1.01, closest, np.inf)
    result = np.where(joined & (ahead + behind > 1e-9), line, alone)
    return np.where(result <= lidar.range_max, result, np.inf)


def _turn(angle: Floats) -> Floats:
    """The angle in [0, 2 pi) [rad]; one that rounding made slightly negative is 0."""
    result: Floats = wrap(angle, 0.0)
    return np.where(result > FULL_TURN - 1e-9, 0.0, result)


def _nearest_in_columns(angles: Floats, ranges: Floats, step: float) -> tuple[Floats, Floats]:
    """Directions, sorted, and ranges of the nearest point of each direction; channels share their directions."""
    columns = np.round(_turn(angles - angles[0]) / step).astype(np.int64) % round(FULL_TURN / step)
    order = np.lexsort((ranges, columns))
    first = np.unique(columns[order], return_index=True)[1]
    chosen = order[first]
    result = wrap(angles[chosen])
    sequence = np.argsort(result, kind="stable")
    return result[sequence], ranges[chosen][sequence]


_MAX_FRAMES = 64
"""Number of frames that wait at most; a server that another client ticks goes on while irsim computes."""
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
    result = []
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
        result.append(AttachedLidar(sensor, lidar, options, count, (x, y, yaw), half))
    return result
