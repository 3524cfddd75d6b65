"""The body of an object: shape, outline, extent, in the body frame or where it stands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.scenario.objects import ObjectRecord
    from irsim.simulation import Simulation

__all__ = ["ObjectBody", "column"]

Floats = NDArray[np.float64]
_CIRCLE_POINTS = 64
_RADIUS_MARGIN = 0.1
"""What avoidance methods of IR-SIM add to a body's radius [m]."""


def column(values: Any) -> Floats:
    """(n, 1) read-only copy."""
    copied = np.array(values, dtype=np.float64).reshape(-1, 1)
    copied.setflags(write=False)
    return copied


class ObjectBody:
    """Geometry of one row of a simulation."""

    _simulation: Simulation
    record: ObjectRecord
    row: int

    @property
    def shape(self) -> str:
        """Name of the shape."""
        return str(getattr(self.record.shape, "name", ""))

    @property
    def kinematics(self) -> str | None:
        """Name of the drive; None for objects that have none."""
        return None if self.record.kinematics is None else str(getattr(self.record.kinematics, "name", ""))

    @property
    def radius(self) -> float:
        """Radius of the smallest circle round the body [m]."""
        return float(self._simulation.radius[self.row])

    @property
    def radius_extend(self) -> float:
        """``radius`` plus the margin that avoidance methods keep."""
        return self.radius + _RADIUS_MARGIN

    @property
    def vertices(self) -> Floats | None:
        """(2, M) outline in the world frame: 64 points for a circle, None for a compound."""
        return self._outline(world_frame=True)

    @property
    def original_vertices(self) -> Floats | None:
        """(2, M) outline in the body frame."""
        return self._outline(world_frame=False)

    @property
    def part_vertices(self) -> list[Floats] | None:
        """Outlines of the parts of a compound, (2, M) each, world frame; None for simple shapes."""
        if self.shape != "compound":
            return None
        return [self._part(i, world_frame=True) for i in range(len(self._simulation.state.parts(self.row)))]

    @property
    def length(self) -> float:
        """Extent of the body along its x axis [m]."""
        return self._extent(0)

    @property
    def width(self) -> float:
        """Extent of the body along its y axis [m]."""
        return self._extent(1)

    @property
    def geometry(self) -> Any:
        """The body as a shapely geometry, world frame (circles as polygons of 64 vertices)."""
        from irsim.world.geometry import shapely_geometry

        return shapely_geometry(self._simulation, self.row, world_frame=True)

    @property
    def original_geometry(self) -> Any:
        """The body as a shapely geometry, body frame."""
        from irsim.world.geometry import shapely_geometry

        return shapely_geometry(self._simulation, self.row, world_frame=False)

    @property
    def centroid(self) -> Floats:
        """(2, 1) centre of the body's area, world frame."""
        point = self.geometry.centroid
        return column([point.x, point.y])

    def _part(self, part: int, *, world_frame: bool) -> Floats:
        state = self._simulation.state
        if state.parts(self.row)[part] == "circle":
            x, y, radius = state.circle(self.row, part, world_frame)
            turn = float(self._simulation.pose[self.row, 2]) if world_frame else 0.0
            angles = turn - np.arange(_CIRCLE_POINTS) * (2 * math.pi / _CIRCLE_POINTS)
            return np.vstack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
        return state.vertices(self.row, part, world_frame).T.copy()

    def _outline(self, *, world_frame: bool) -> Floats | None:
        return None if self.shape in ("compound", "map") else self._part(0, world_frame=world_frame)

    def _extent(self, axis: int) -> float:
        state = self._simulation.state
        low, high = math.inf, -math.inf
        for part, kind in enumerate(state.parts(self.row)):
            if kind == "circle":
                *centre, radius = state.circle(self.row, part, False)
                low, high = min(low, centre[axis] - radius), max(high, centre[axis] + radius)
            else:
                along = state.vertices(self.row, part, False)[:, axis]
                low, high = min(low, float(along.min())), max(high, float(along.max()))
        return high - low
