"""The body of an object: shape, outline and extent, in the body frame or in the world frame."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Polygon, outline, points_of
from irsim.functions.inequalities import polygon_inequality
from irsim.objects.base import SimObject, column
from irsim.objects.neighbors import AVOIDANCE_MARGIN, centres

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["ObjectBody", "convex_inequality"]

Inequality = tuple[Floats | None, Floats | None, str | None, bool | None]
_CIRCLE_POINTS = 64
"""Number of vertices of the polygon that stands for a circle."""
MAX_STRAIGHT_CORNER = 1e-12
"""Largest cross product [m^2] of the two edges at a corner that counts as straight."""


def convex_inequality(simulation: Simulation, row: int, *, world_frame: bool) -> Inequality:
    """Return a body as the inequality ``G p <= h``, for convex optimisation.

    Returns:
        (G, h, cone, convex). A convex polygon has one row per edge with its outward normal, not normalised, and the
        cone ``"Rpositive"``. A circle has ``G = [[1, 0], [0, 1], [0, 0]]``, ``h = [cx, cy, -r]`` and the cone
        ``"norm2"``. Other areas give None, None, None, False; lines and maps give four times None.
    """
    match outline(simulation.state, row, world_frame=world_frame).parts:
        case (Circle((x, y), radius),):
            return np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), np.array([[x], [y], [-radius]]), "norm2", True
        case (Polygon(points),):
            found = polygon_inequality(points, MAX_STRAIGHT_CORNER)
        case parts:
            return None, None, None, None if len(parts) == 1 else False
    return (None, None, None, False) if found is None else (*found, "Rpositive", True)


class ObjectBody(SimObject):
    """Geometry of one object; part of :class:`irsim.objects.view.ObjectView`."""

    @property
    def radius(self) -> float:
        """Radius of the smallest circle round the body [m]."""
        return float(self._simulation.radius[self.row])

    @property
    def radius_extend(self) -> float:
        """``radius`` plus the margin that avoidance laws add [m]."""
        return self.radius + AVOIDANCE_MARGIN

    @property
    def vertices(self) -> Floats | None:
        """Outline in the world frame, (2, M) [m]: 64 points for a circle, None for a compound or a map."""
        return self._outline(world_frame=True)

    @property
    def original_vertices(self) -> Floats | None:
        """Outline in the body frame, (2, M) [m]; None for a compound or a map."""
        return self._outline(world_frame=False)

    @property
    def part_vertices(self) -> list[Floats] | None:
        """Outlines of the parts of a compound, (2, M) each, world frame; None for simple shapes."""
        return self._outlines(world_frame=True) if self.shape == "compound" else None

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
        return outline(self._simulation.state, self.row, world_frame=True).shapely()

    @property
    def original_geometry(self) -> Any:
        """The body as a shapely geometry, body frame."""
        return outline(self._simulation.state, self.row).shapely()

    @property
    def centroid(self) -> Floats:
        """Centre of the body's area in the world frame, (2, 1) [m]."""
        x, y, theta = self._simulation.pose[self.row].tolist()
        a, b = self._centre()
        c, s = math.cos(theta), math.sin(theta)
        return column([x + c * a - s * b, y + s * a + c * b])

    @property
    def original_centroid(self) -> Floats:
        """Centre of the body's area in the body frame, (2, 1) [m]."""
        return column(self._centre())

    @property
    def original_state(self) -> Floats:
        """Centre of the body's area [m] and heading 0 [rad] in the body frame, (3, 1)."""
        return column([*self.original_centroid[:, 0], 0.0])

    @property
    def original_part_vertices(self) -> list[Floats] | None:
        """Outlines of the parts of a compound, (2, M) each, body frame; None for simple shapes."""
        return self._outlines(world_frame=False) if self.shape == "compound" else None

    @property
    def goal_vertices(self) -> Floats | None:
        """Outline at the present goal in the world frame, (2, M) [m]; None without a goal, or for a compound or map."""
        x, y, theta = self._simulation.goal[self.row].tolist()
        outline = self.original_vertices
        if outline is None or math.isnan(x):
            return None
        turn = 0.0 if math.isnan(theta) else theta
        c, s = math.cos(turn), math.sin(turn)
        moved: Floats = np.array([[c, -s], [s, c]]) @ outline + [[x], [y]]
        return moved

    # convex inequality -----------------------------------------------------------------------------------------------
    @property
    def G(self) -> Floats | None:
        """Normals of ``G p <= h`` in the body frame; see :func:`irsim.objects.geometry.convex_inequality`."""
        return self.get_init_Gh()[0]

    @property
    def h(self) -> Floats | None:
        """Right side of ``G p <= h`` in the body frame."""
        return self.get_init_Gh()[1]

    @property
    def cone_type(self) -> str | None:
        """``Rpositive`` for convex polygons, ``norm2`` for circles, else None."""
        return self.get_init_Gh()[2]

    @property
    def convex_flag(self) -> bool | None:
        """Whether the body is convex; None for lines and maps."""
        return self.get_init_Gh()[3]

    def get_init_Gh(self) -> Inequality:
        """Return (G, h, cone_type, convex_flag) of the body in the body frame."""
        return convex_inequality(self._simulation, self.row, world_frame=False)

    def get_Gh(self) -> Inequality:
        """Return (G, h, cone_type, convex_flag) of the body at its present pose in the world frame."""
        return convex_inequality(self._simulation, self.row, world_frame=True)

    def _centre(self) -> list[float]:
        world, index = divmod(self.row, self._simulation.objects)
        centre: list[float] = centres(self._simulation, world)[index].tolist()
        return centre

    def _outlines(self, *, world_frame: bool) -> list[Floats]:
        """(2, M) points of each part; those of a circle run clockwise from its heading."""
        turn = float(self._simulation.pose[self.row, 2]) if world_frame else 0.0
        angles = turn - np.arange(_CIRCLE_POINTS) * (2 * math.pi / _CIRCLE_POINTS)
        found: list[Floats] = []
        for part in outline(self._simulation.state, self.row, world_frame=world_frame).parts:
            if isinstance(part, Circle):
                (x, y), radius = part.center, part.radius
                found.append(np.vstack([x + radius * np.cos(angles), y + radius * np.sin(angles)]))
            else:
                found.append(points_of(part).T.copy())
        return found

    def _outline(self, *, world_frame: bool) -> Floats | None:
        return None if self.shape in ("compound", "map") else self._outlines(world_frame=world_frame)[0]

    def _extent(self, axis: int) -> float:
        low, high = outline(self._simulation.state, self.row).box()
        return float(high[axis] - low[axis])
