"""The other objects of the world of an object: all, near ones, touched ones, seen ones."""

from __future__ import annotations

from typing import Any

from irsim.common.outline import outline
from irsim.objects.base import SimObject

__all__ = ["Surroundings"]


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
