"""The fog over the world: the cells that no robot has seen yet."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import irsim._core as core
from irsim.components.maps._site import HALF
from irsim.diagnostics.errors import InputError
from irsim.simulation.occupancy import grid_collision_geometry, grid_occupied

if TYPE_CHECKING:
    from irsim.scenario.resolve.resolved import ResolvedScenario

__all__ = ["DEFAULT_RESOLUTION", "FOG_COLOR", "FogMap", "build_fog", "fog_resolution", "fog_shape"]


DEFAULT_RESOLUTION = 0.1
"""Cell size [m] if neither the scenario nor a map gives one."""
FOG_COLOR = (0.78, 0.78, 0.8)
_FULL_TURN = 2 * math.pi


def fog_shape(width: float, height: float, resolution: float) -> tuple[int, int]:
    """Return the number of cells along x and y whose size is closest to the resolution; at least one."""
    return max(1, round(width / resolution)), max(1, round(height / resolution))


def fog_resolution(scenario: ResolvedScenario) -> float:
    """Return the cell size [m] that the scenario asks for: its own, the one of its map along x, or the default."""
    world = scenario.world
    if world.fog_map_resolution is not None:
        return float(world.fog_map_resolution)
    return DEFAULT_RESOLUTION if scenario.grid is None else float(scenario.grid.cell[0])


def build_fog(scenario: ResolvedScenario) -> core.Fog | None:
    """Build the fog of a scenario, which its robots clear; None without ``fog_map``."""
    world = scenario.world
    if not world.fog_map:
        return None
    columns, rows = fog_shape(world.width, world.height, fog_resolution(scenario))
    carriers, views = [], []
    for index, record in enumerate(scenario.objects):
        if record.role != "robot":
            continue
        if any(getattr(sensor, "is_lidar", False) for sensor in record.sensors):
            carriers.append(index)
        elif record.fov is not None and record.fov_radius is not None:
            views.append(
                core.View(object=index, angle=record.fov, reach=record.fov_radius, occlusion=record.fov_occlusion)
            )
    return core.Fog(
        origin=[float(v) for v in world.offset[:2]],
        size=[float(world.width), float(world.height)],
        columns=columns,
        rows=rows,
        carriers=carriers,
        views=views,
    )


class FogMap:
    """A grid of explored and unexplored cells; an environment has it as ``env._world.fog_map``.

    Args:
        width: Extent along x [m].
        height: Extent along y [m].
        resolution: Approximate cell size [m]; the exact size divides the extent evenly.
        world_offset: Lower left corner [m].

    Attributes:
        cells: (nx, ny) flags, 1 for explored cells.
        obstacle_list: Obstacles for :meth:`is_collision`: shapely geometries, or anything with a ``geometry``.
        grid: (nx, ny) occupancy for ``grid_occupied`` and ``is_collision``; None by default.

    Raises:
        ValueError: ``resolution`` is not a positive number.
    """

    def __init__(
        self,
        width: float = 10,
        height: float = 10,
        resolution: float = DEFAULT_RESOLUTION,
        world_offset: Sequence[float] | None = None,
    ) -> None:
        if not (math.isfinite(resolution) and resolution > 0):
            raise InputError(f"the resolution of a fog map must be a positive number [m], got {resolution!r}")
        self.width, self.height, self.resolution = width, height, resolution
        x, y = (0.0, 0.0) if world_offset is None else world_offset[:2]
        self.world_offset = (float(x), float(y))
        nx, ny = fog_shape(width, height, resolution)
        self.obstacle_list: list[Any] = []
        self.grid: NDArray[np.float64] | None = None
        self.cells: NDArray[np.uint8] = np.zeros((nx, ny), dtype=np.uint8)
        self._size = np.array([width / nx, height / ny])

    @property
    def explored(self) -> NDArray[np.bool_]:
        """(nx, ny) whether each cell has been seen, first axis along x; a read-only copy."""
        explored = self.cells.astype(bool)
        explored.setflags(write=False)
        return explored

    @property
    def explored_ratio(self) -> float:
        """Share of cells that have been seen, 0 to 1."""
        return float(np.count_nonzero(self.cells)) / self.cells.size

    @property
    def shape(self) -> tuple[int, int]:
        """Number of cells along x and y."""
        nx, ny = self.cells.shape
        return nx, ny

    @property
    def grid_resolution(self) -> tuple[float, float]:
        """Size of a cell along x and y [m]."""
        return float(self._size[0]), float(self._size[1])

    def reset(self) -> None:
        """Mark all cells as unexplored."""
        self.cells[:] = 0

    def reveal_from_lidar(self, origin: Any, angles: Any, ranges: Any) -> None:
        """Mark the cells along the beams of a scan, sampled every half cell, and the cells in which the beams end.

        Args:
            origin: x, y [m] and heading [rad] of the sensor, world frame.
            angles: (B,) beam angles in the sensor frame [rad].
            ranges: (B,) measured ranges [m].

        Raises:
            ValueError: A range is not finite.
        """
        x, y, heading = np.asarray(origin, dtype=np.float64).reshape(-1)[:3]
        bearings = heading + np.asarray(angles, dtype=np.float64).reshape(-1)
        reach = np.asarray(ranges, dtype=np.float64).reshape(-1)
        if not reach.size:
            return
        if not np.isfinite(reach).all():
            raise InputError("ranges must be finite numbers")
        step = 0.5 * float(self._size.min())
        along = np.minimum(np.arange(int(reach.max() / step) + 2) * step, reach[:, None])
        self._mark(x + along * np.cos(bearings)[:, None], y + along * np.sin(bearings)[:, None])

    def reveal_fov(self, origin: Any, fov: float, fov_radius: float) -> None:
        """Mark the cells whose centre lies in a field of view.

        Args:
            origin: x, y [m] and heading [rad] of the robot, world frame.
            fov: Opening angle [rad]; 2 pi or more stands for all directions.
            fov_radius: Range [m].
        """
        x, y, heading = np.asarray(origin, dtype=np.float64).reshape(-1)[:3]
        nx, ny = self.cells.shape
        dx = (self.world_offset[0] + (np.arange(nx) + 0.5) * self._size[0] - x)[:, None]
        dy = (self.world_offset[1] + (np.arange(ny) + 0.5) * self._size[1] - y)[None, :]
        seen = np.hypot(dx, dy) <= fov_radius
        if fov < _FULL_TURN:
            off = (np.arctan2(dy, dx) - heading + math.pi) % _FULL_TURN - math.pi
            seen &= np.abs(off) <= fov / 2
        self.cells[seen] = 1

    def grid_occupied(
        self, x: float, y: float, margin_x: float = 0.0, margin_y: float = 0.0, threshold: float = HALF
    ) -> bool | None:
        """Whether a cell of ``grid`` is occupied near (x, y); see :meth:`irsim.navigation.map.Map.grid_occupied`."""
        if self.grid is None:
            return None
        x0, y0 = self.world_offset
        return grid_occupied(
            self.grid, (x0, y0, x0 + self.width, y0 + self.height), x, y, margin_x, margin_y, threshold
        )

    def is_collision(self, geometry: Any) -> bool:
        """Whether a shapely geometry leaves the map, or touches an occupied cell or an item of ``obstacle_list``."""
        x0, y0 = self.world_offset
        low_x, low_y, high_x, high_y = geometry.bounds
        if low_x < x0 or low_y < y0 or high_x > x0 + self.width or high_y > y0 + self.height:
            return True
        if self.grid is not None:
            cell = self.width / self.grid.shape[0], self.height / self.grid.shape[1]
            if grid_collision_geometry(self.grid, cell, geometry, self.world_offset):
                return True
        return any(geometry.intersects(getattr(thing, "geometry", thing)) for thing in self.obstacle_list)

    def plot_clear(self) -> None:
        """Do nothing: the picture of an environment draws the fog, which has no artists of its own."""

    def to_rgba(self, color: Sequence[float] = FOG_COLOR, alpha: float = 1.0) -> NDArray[np.float64]:
        """Return the (nx, ny, 4) colour and opacity of each cell; explored cells are transparent."""
        rgba = np.empty((*self.cells.shape, 4))
        rgba[..., :3] = color
        rgba[..., 3] = np.where(self.cells, 0.0, alpha)
        return rgba

    def _mark(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
        i = np.floor((x - self.world_offset[0]) / self._size[0])
        j = np.floor((y - self.world_offset[1]) / self._size[1])
        inside = (i >= 0) & (j >= 0) & (i < self.cells.shape[0]) & (j < self.cells.shape[1])
        self.cells[i[inside].astype(int), j[inside].astype(int)] = 1
