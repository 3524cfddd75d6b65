"""The body of an object: its outline and extent, in the body frame or in the world frame, and its mass."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.outline import Circle, outline, points_of
from irsim.objects.base import SimObject, column
from irsim.objects.surroundings import centres

__all__ = ["Body"]

_CIRCLE_POINTS = 64
"""Number of vertices of the polygon that stands for a circle."""


class Body:
    """The body of one object, ``robot.body``; masses and forces matter in ``collision_mode: contact``."""

    def __init__(self, view: SimObject) -> None:
        self._object = view

    @property
    def radius(self) -> float:
        """Radius of the smallest circle round the body [m]."""
        return float(self._object._simulation.radius[self._object.row])

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
        return self._outlines(world_frame=True) if self._shape == "compound" else None

    @property
    def original_part_vertices(self) -> list[Floats] | None:
        """Outlines of the parts of a compound, (2, M) each, body frame; None for simple shapes."""
        return self._outlines(world_frame=False) if self._shape == "compound" else None

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
        return outline(self._object._simulation.state, self._object.row, world_frame=True).shapely()

    @property
    def original_geometry(self) -> Any:
        """The body as a shapely geometry, body frame."""
        return outline(self._object._simulation.state, self._object.row).shapely()

    @property
    def centroid(self) -> Floats:
        """Centre of the body's area in the world frame, (2, 1) [m]."""
        x, y, theta = self._object._simulation.pose[self._object.row].tolist()
        a, b = self._centre()
        c, s = math.cos(theta), math.sin(theta)
        return column([x + c * a - s * b, y + s * a + c * b])

    @property
    def original_centroid(self) -> Floats:
        """Centre of the body's area in the body frame, (2, 1) [m]."""
        return column(self._centre())

    @property
    def goal_vertices(self) -> Floats | None:
        """Outline at the present goal in the world frame, (2, M) [m]; None without a goal, or for a compound or map."""
        x, y, theta = self._object._simulation.goal[self._object.row].tolist()
        outline = self.original_vertices
        if outline is None or math.isnan(x):
            return None
        turn = 0.0 if math.isnan(theta) else theta
        c, s = math.cos(turn), math.sin(turn)
        moved: Floats = np.array([[c, -s], [s, c]]) @ outline + [[x], [y]]
        return moved

    # mass ------------------------------------------------------------------------------------------------------------
    @property
    def mass(self) -> float:
        """Mass [kg]; infinite for objects that contacts cannot push."""
        return self._object.record.mass

    @property
    def friction(self) -> float:
        """Coefficient of friction with the ground."""
        return self._object.record.friction

    @property
    def restitution(self) -> float:
        """Bounciness, 0 to 1."""
        return self._object.record.restitution

    @property
    def inertia(self) -> float:
        """Moment of inertia about the centroid [kg m^2]."""
        given = self._object.record.inertia
        return self.mass * self._kernel()[2] if given is None else given

    @property
    def inv_mass(self) -> float:
        """1 / mass [1/kg]; 0 for objects that contacts cannot push."""
        return self._kernel()[0]

    @property
    def inv_inertia(self) -> float:
        """1 / inertia [1/(kg m^2)]; 0 for objects that contacts cannot push."""
        return self._kernel()[1]

    @property
    def gyration(self) -> float:
        """Radius of gyration [m], the square root of inertia over mass; 0 for an infinite mass."""
        return math.sqrt(self.inertia / self.mass) if math.isfinite(self.mass) else 0.0

    @property
    def pushable(self) -> bool:
        """Whether contacts can move the object.

        That requires a finite mass, and that it is neither static nor an obstacle that replays a recording.
        """
        record = self._object.record
        replays = record.recorded and record.role == "obstacle"
        return not self._object.static and math.isfinite(self.mass) and not replays

    @property
    def friction_force(self) -> float:
        """Largest friction force of the ground [N]: traction of a drive, or resistance of a passive body."""
        gravity = self._object._simulation.scenario.world.gravity
        return self.friction * self.mass * gravity if self.friction > 0.0 else 0.0

    # -----------------------------------------------------------------------------------------------------------------
    @property
    def _shape(self) -> str:
        return str(getattr(self._object.record.shape, "name", ""))

    def _kernel(self) -> tuple[float, ...]:
        """1 / mass, 1 / inertia, inertia / mass, and further numbers of the core."""
        return self._object._simulation.state.body(self._object.row)

    def _centre(self) -> list[float]:
        world, index = divmod(self._object.row, self._object._simulation.objects)
        centre: list[float] = centres(self._object._simulation, world)[index].tolist()
        return centre

    def _outlines(self, *, world_frame: bool) -> list[Floats]:
        """(2, M) points of each part; the points of a circle run clockwise from its heading."""
        simulation, row = self._object._simulation, self._object.row
        turn = float(simulation.pose[row, 2]) if world_frame else 0.0
        angles = turn - np.arange(_CIRCLE_POINTS) * (2 * math.pi / _CIRCLE_POINTS)
        outlines: list[Floats] = []
        for part in outline(simulation.state, row, world_frame=world_frame).parts:
            if isinstance(part, Circle):
                (x, y), radius = part.center, part.radius
                outlines.append(np.vstack([x + radius * np.cos(angles), y + radius * np.sin(angles)]))
            else:
                outlines.append(points_of(part).T.copy())
        return outlines

    def _outline(self, *, world_frame: bool) -> Floats | None:
        return None if self._shape in ("compound", "map") else self._outlines(world_frame=world_frame)[0]

    def _extent(self, axis: int) -> float:
        low, high = outline(self._object._simulation.state, self._object.row).box()
        return float(high[axis] - low[axis])
