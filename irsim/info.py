"""Plain descriptions of objects, for scripts and planners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from irsim.views import ObjectView

__all__ = ["ObjectInfo", "ObstacleInfo", "convex_inequality"]

Floats = NDArray[np.float64]


def convex_inequality(view: ObjectView) -> tuple[Floats | None, Floats | None, str | None, bool]:
    """The body as ``G p <= h`` in the body frame, for convex optimisation.

    Returns:
        (G, h, cone, convex). Convex polygons: one row per edge, outward normals (not normalised), cone
        ``"Rpositive"``. Circles: ``G = [[1, 0], [0, 1], [0, 0]]``, ``h = [cx, cy, -r]``, cone ``"norm2"``. Otherwise
        None, None, None, False.
    """
    state = view._simulation.state
    kinds = state.parts(view.row)
    if kinds == ["circle"]:
        x, y, radius = state.circle(view.row, 0, False)
        return np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]), np.array([[x], [y], [-radius]]), "norm2", True
    if kinds != ["polygon"]:
        return None, None, None, False
    points = state.vertices(view.row, 0, False)
    edges = np.roll(points, -1, axis=0) - points
    ahead = np.roll(edges, -1, axis=0)
    turns = edges[:, 0] * ahead[:, 1] - edges[:, 1] * ahead[:, 0]
    if not ((turns >= 0).all() or (turns <= 0).all()):
        return None, None, None, False
    if turns.sum() < 0:
        points = points[::-1]
        edges = np.roll(points, -1, axis=0) - points
    normals = np.column_stack([edges[:, 1], -edges[:, 0]])
    return normals, (normals * points).sum(axis=1, keepdims=True), "Rpositive", True


@dataclass
class _Extensible:
    def add_property(self, key: str, value: Any) -> None:
        """Attach another attribute."""
        setattr(self, key, value)


@dataclass
class ObjectInfo(_Extensible):
    """What an object is; arrays are columns."""

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
    convex_flag: bool
    name: str
    mass: float
    friction: float
    inertia: float | None
    restitution: float

    @classmethod
    def of(cls, view: ObjectView) -> ObjectInfo:
        """The description of ``view`` now."""
        record = view.record
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
            *convex_inequality(view),
            view.name,
            record.mass,
            record.friction,
            record.inertia,
            record.restitution,
        )


@dataclass
class ObstacleInfo(_Extensible):
    """Where an obstacle is and how big; ``G`` and ``h`` are in its body frame."""

    center: Floats
    vertex: Floats | None
    velocity: Floats
    radius: float
    G: Floats | None
    h: Floats | None
    cone_type: str | None
    convex_flag: bool

    @classmethod
    def of(cls, view: ObjectView) -> ObstacleInfo:
        """The description of ``view`` now."""
        return cls(view.position, view.vertices, view.velocity, view.radius, *convex_inequality(view))
