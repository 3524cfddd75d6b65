"""Plain descriptions of objects, for scripts and planners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.arrays import Floats

__all__ = ["ObjectInfo", "ObstacleInfo"]


@dataclass
class _Extensible:
    def add_property(self, key: str, value: Any) -> None:
        """Add an attribute."""
        setattr(self, key, value)


@dataclass
class ObjectInfo(_Extensible):
    """Description of an object; arrays are columns."""

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
        return cls(
            view.id,
            view.shape,
            view.kinematics,
            view.role,
            view.color,
            view.static,
            view.goal,
            view.vel_min,
            view.vel_max,
            view.acce,
            np.array(record.angle_range, dtype=np.float64).reshape(2, 1),
            view.goal_threshold,
            view.wheelbase,
            normals,
            right_side,
            cone,
            convex,
            view.name,
            record.mass,
            record.friction,
            view.inertia,
            record.restitution,
        )


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
