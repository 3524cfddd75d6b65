"""Plain descriptions of objects, for scripts and planners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.arrays import Floats

__all__ = ["ObjectInfo", "ObstacleInfo"]


_OF_VIEW = (
    *("id", "shape", "kinematics", "role", "color", "static", "goal", "vel_min", "vel_max", "acce"),
    *("goal_threshold", "wheelbase", "name", "inertia"),
)
"""Attributes of a description that have the same name at the object."""


@dataclass
class _Extensible:
    def add_property(self, key: str, value: Any) -> None:
        """Add an attribute."""
        setattr(self, key, value)


class _Kept:
    """Attributes that scripts have added to a description; the object keeps them for its later descriptions."""

    _added: dict[str, Any]

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)
        # The fields belong to the classes below, which are dataclasses; this base is not one.
        if "_added" in self.__dict__ and name not in type(self).__dataclass_fields__:  # type: ignore[attr-defined]
            self._added[name] = value

    def _keep(self, added: dict[str, Any]) -> None:
        """Take the attributes in ``added``, and enter further ones there."""
        self.__dict__.update(added, _added=added)


@dataclass
class ObjectInfo(_Kept, _Extensible):
    """Description of an object; arrays are columns.

    Attributes that a script adds, with :meth:`add_property` or by assignment, belong to every later description of the
    object, too.
    """

    id: int
    shape: str
    kinematics: str | None
    role: str
    color: Any
    static: bool
    goal: Floats | None
    vel_min: Floats
    vel_max: Floats
    acce: Floats
    angle_range: Floats
    goal_threshold: float
    wheelbase: float | None
    G: Floats | None
    h: Floats | None
    cone_type: str | None
    convex_flag: bool | None
    name: str
    mass: float
    friction: float
    inertia: float
    restitution: float

    @classmethod
    def of(cls, view: Any) -> ObjectInfo:
        """Return the description of an object at the present time."""
        record = view.record
        normals, right_side, cone, convex = view.get_init_Gh()
        made = cls(
            **{name: getattr(view, name) for name in _OF_VIEW},
            **{name: getattr(record, name) for name in ("mass", "friction", "restitution")},
            angle_range=np.array(record.angle_range, dtype=np.float64).reshape(2, 1),
            G=normals,
            h=right_side,
            cone_type=cone,
            convex_flag=convex,
        )
        made._keep(view.__dict__.setdefault("_info_properties", {}))
        return made


@dataclass
class ObstacleInfo(_Extensible):
    """Position and size of an obstacle, in the world frame; ``G`` and ``h`` are in the body frame."""

    center: Floats
    vertex: Floats | None
    velocity: Floats
    radius: float
    G: Floats | None
    h: Floats | None
    cone_type: str | None
    convex_flag: bool | None

    @classmethod
    def of(cls, view: Any) -> ObstacleInfo:
        """Return the description of an object at the present time."""
        return cls(view.position, view.vertices, view.velocity, view.radius, *view.get_init_Gh())
