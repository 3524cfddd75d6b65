"""Lidars in MuJoCo: rays at the mounts of irsim's lidars, and the difference between both ranges."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.mujoco.mjcf import body_name
from irsim.bridges.mujoco.physics import Physics
from irsim.bridges.mujoco.robots import LIDAR_HEIGHT
from irsim.common.arrays import Floats
from irsim.simulation.scene import Lidar, SceneObject

__all__ = ["Rays"]

_SEEN_GROUPS = np.array([1, 0, 0, 0, 1, 0], dtype=np.uint8)
"""Groups of geoms that lidars see."""


class Rays:
    """Casts the rays of all lidars of a scene.

    Args:
        physics: The model.
    """

    def __init__(self, physics: Physics) -> None:
        import mujoco

        self.physics = physics
        self._cast: Any = mujoco.mj_multiRay
        self._normals = "normal" in (inspect.getdoc(mujoco.mj_multiRay) or "")  # an argument since 3.4
        self.lidars: list[tuple[SceneObject, Lidar, int]] = []
        for agent in physics.scene.agents:
            body = physics.model.body(body_name(agent)).id if agent.parts else -1
            self.lidars += [(agent, lidar, body) for lidar in agent.lidars]

    def scan(self, pose: Floats) -> dict[str, NDArray[np.float32]]:
        """Ranges of all lidars whose carriers are in the world; the model has to be placed already.

        Args:
            pose: (N, 3) poses of all objects.

        Returns:
            Key of a lidar -> (beams,) ranges [m]; infinite for a beam that hits nothing within the range.
        """
        return {
            lidar.key: self._ranges(pose[agent.index], lidar, body)
            for agent, lidar, body in self.lidars
            if np.isfinite(pose[agent.index]).all()
        }

    def _ranges(self, pose: Floats, lidar: Lidar, body: int) -> NDArray[np.float32]:
        x, y, yaw = pose.tolist()
        cosine, sine = np.cos(yaw), np.sin(yaw)
        mx, my, turned = lidar.mount
        origin = np.array([x + cosine * mx - sine * my, y + sine * mx + cosine * my, LIDAR_HEIGHT])
        angles = lidar.angles + (yaw + turned)
        beams = np.stack([np.cos(angles), np.sin(angles), np.zeros(lidar.beams)], axis=1)
        hit = np.full(lidar.beams, -1, dtype=np.int32)
        distance = np.full(lidar.beams, -1.0)
        arguments = [
            self.physics.model,
            self.physics.data,
            origin,
            beams.ravel(),
            _SEEN_GROUPS,
            True,
            body,
            hit,
            distance,
        ]
        if self._normals:
            arguments.append(None)
        self._cast(*arguments, lidar.beams, lidar.range_max)
        reached = (hit >= 0) & (distance >= lidar.range_min) & (distance <= lidar.range_max)
        return np.where(reached, distance, np.inf).astype(np.float32)


class LidarComparison:
    """Collects differences between the ranges of irsim and of MuJoCo.

    Attributes:
        beams: Number of beams that both have measured.
        one_sided: Number of beams that hit something in one simulator only.
        largest: Largest difference of a beam [m].
    """

    _BINS = np.concatenate([[0.0], np.logspace(-7, 2, 181)])

    def __init__(self) -> None:
        self.beams = self.one_sided = 0
        self.largest = 0.0
        self._counts = np.zeros(len(self._BINS), dtype=np.int64)

    def add(self, ours: Mapping[str, NDArray[np.float32]], theirs: Mapping[str, NDArray[np.float32]]) -> None:
        """Compare scans that were taken at the same time."""
        for key in ours.keys() & theirs.keys():
            one, other = ours[key].astype(np.float64), theirs[key].astype(np.float64)
            both = np.isfinite(one) & np.isfinite(other)
            self.one_sided += int((np.isfinite(one) != np.isfinite(other)).sum())
            differences = np.abs(one[both] - other[both])
            self.beams += len(differences)
            if len(differences):
                self.largest = max(self.largest, float(differences.max()))
                places = np.searchsorted(self._BINS, differences)
                self._counts += np.bincount(np.minimum(places, len(self._BINS) - 1), minlength=len(self._BINS))

    def quantile(self, share: float) -> float:
        """Difference that this share of the beams does not exceed [m], rounded up by at most 12 %."""
        if not self.beams:
            return 0.0
        place = int(np.searchsorted(np.cumsum(self._counts), share * self.beams))
        return float(min(self._BINS[min(place, len(self._BINS) - 1)], self.largest))
