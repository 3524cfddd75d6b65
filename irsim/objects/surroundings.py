"""The other objects of a world as one object knows them, and the centres and discs of all bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from irsim.common.arrays import Floats
from irsim.common.outline import Circle, outline
from irsim.objects.base import SimObject

if TYPE_CHECKING:
    from irsim.simulation.simulation import Simulation

__all__ = ["AVOIDANCE_MARGIN", "Surroundings", "centres", "discs"]

AVOIDANCE_MARGIN = 0.1
"""Margin [m] that the avoidance laws of IR-SIM add to the radius of a body."""


class Surroundings:
    """The other objects of the world of one object, ``robot.surroundings``.

    An object that ``env.create_robot`` has made is surrounded by the objects of the environment even before
    ``env.add_object`` adds it.
    """

    def __init__(self, view: SimObject) -> None:
        self._object = view

    @property
    def objects(self) -> list[Any]:
        """All objects of the world, the object itself too, in the order of their rows."""
        view = self._object
        return view._simulation.views(view.world) if view._made_beside is None else list(view._made_beside)

    @property
    def others(self) -> list[Any]:
        """All other objects of the world."""
        return [other for other in self.objects if other is not self._object]

    @property
    def near(self) -> list[Any]:
        """The other objects with bounding boxes that overlap its own, without ``unobstructed`` objects."""
        view = self._object
        if view._made_beside is None:
            objects = self.objects
            near = [objects[i] for i in view._simulation.state.near_row(view.row)]
            return [other for other in near if not other.unobstructed]
        low, high = outline(view._simulation.state, view.row, world_frame=True).box()
        near = []
        for other in self.others:
            if not other.unobstructed:
                other_low, other_high = outline(other._simulation.state, other.row, world_frame=True).box()
                if (low <= other_high).all() and (other_low <= high).all():
                    near.append(other)
        return near

    @property
    def touched(self) -> list[Any]:
        """The objects that the object touches, without ``unobstructed`` ones."""
        view = self._object
        pairs = view._simulation.state.collision_pairs(view.world)
        others = [int(b if a == view.index else a) for a, b in pairs if view.index in (a, b)]
        objects = self.objects
        return [objects[i] for i in others if not objects[i].unobstructed]

    @property
    def seen(self) -> list[Any]:
        """The other objects of which a part lies in the field of view, ordered by id; empty without one.

        The field of view is a sector of the angle ``fov`` [rad] about the heading and of the radius ``fov_radius`` [m]
        about the origin of the object. With ``fov_occlusion``, parts behind objects that are not ``unobstructed`` are
        hidden and do not count.
        """
        view, record = self._object, self._object.record
        if record.fov is None or record.fov_radius is None:
            return []
        seen = view._simulation.state.in_view(view.row, record.fov, record.fov_radius, record.fov_occlusion)
        objects = self.objects
        return [objects[i] for i in seen]


def centres(simulation: Simulation, world: int) -> Floats:
    """Return the centre of the area of every body of a world in its body frame, (N, 2) [m].

    The body frame of a map is the world frame. Centres are computed once per scene and set of bodies.
    """
    key = simulation.revision, *simulation.key(world)[:2]
    known: dict[int, tuple[tuple[int, int, int], Floats]] = simulation.__dict__.setdefault("_centres", {})
    if world not in known or known[world][0] != key:
        first = world * simulation.objects
        points = [_centre(simulation, first + i) for i in range(simulation.objects)]
        known[world] = key, np.array(points, dtype=np.float64).reshape(-1, 2)
    return known[world][1]


def discs(simulation: Simulation, world: int) -> Floats:
    """Return x, y [m], vx, vy [m/s] and padded radius [m] of every object of a world, (N, 5), in the world frame."""
    size = simulation.objects
    rows = slice(world * size, (world + 1) * size)
    pose, centre = simulation.pose[rows], centres(simulation, world)
    result = np.empty((size, 5))
    result[:, :2] = pose[:, :2]
    if centre.any():
        c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        result[:, 0] += c * centre[:, 0] - s * centre[:, 1]
        result[:, 1] += s * centre[:, 0] + c * centre[:, 1]
    result[:, 2:4] = simulation.state.velocities_world(world)
    if simulation.drives is not None:
        objects = simulation.views(world)
        for index in simulation.drives.objects:
            result[index, 2:4] = objects[index].velocity_xy[:, 0]
    result[:, 4] = simulation.radius[rows] + AVOIDANCE_MARGIN
    return result


def _centre(simulation: Simulation, row: int) -> tuple[float, float]:
    body = outline(simulation.state, row)
    match body.parts:
        case (Circle(center),):
            return center
    point = body.shapely().centroid
    return point.x, point.y
