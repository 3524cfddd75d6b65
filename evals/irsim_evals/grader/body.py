"""One object of a world, however the file expresses it: assertions are about these."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
import shapely.affinity

from irsim.common.outline import outline
from irsim.components.options import BehaviorOptions
from irsim.diagnostics.diagnostic import format_path

if TYPE_CHECKING:
    from irsim.objects.view import ObjectView
    from irsim.scenario.resolve.resolved import ObjectRecord, ResolvedScenario

__all__ = ["Box", "GradedBody", "body_of"]

_STRAIGHT = 1e-6
"""Largest deviation [m] of an outline from a rectangle that counts as none."""


_SIDES = {
    "sideways": ("leftward", "rightward"), "turn": ("turn_left", "turn_right"), "steer": ("steer_left", "steer_right"),
}  # fmt: skip
"""Range → those to the two sides."""


@dataclass(frozen=True)
class Box:
    """A rectangular footprint.

    Attributes:
        length, width: Sides along and across ``heading`` [m]; a line has the width 0.
        heading: Direction of the longer side, world frame [rad], in [0, π).
        center: Middle [m].
    """

    length: float
    width: float
    heading: float
    center: tuple[float, float]


@dataclass(frozen=True)
class GradedBody:
    """One object at the start of an episode (world frame, m, rad, s).

    Attributes:
        index: Its row in the simulation.
        record: Its record in the resolved scenario.
        static: Whether it never moves, as obstacles without a behavior.
        kinematics: Name of its drive; None for a static object.
        behavior: Name of the behavior that moves it, its own or its group's.
        options: Options of that behavior.
        pose: x, y, heading.
        goals: Its goals in order; empty for objects to which the file gives no goal.
        footprint: Outline, a shapely geometry.
        radius: Radius of a disc; None for other shapes.
        box: The rectangle that the footprint is; None for other shapes.
        extent: Length and width in the body frame, along and across its heading.
        ranges: Greatest speeds ``forward``, ``backward``, ``leftward``, ``rightward`` [m/s], turn rates ``turn_left``,
            ``turn_right`` [rad/s] and steering angles ``steer_left``, ``steer_right`` [rad] that its limits, its drive
            and its behavior allow; ``sideways``, ``turn`` and ``steer`` are the larger value of both sides. An entry is
            missing if its drive has no such motion or nothing limits it.
        avoided: Role of the objects that it avoids, or ``all``; None if it avoids none.
        sensors: Options of each sensor as the simulator holds them.
        color: As ``#rrggbb`` where it is a color; None for the color of its role.
        limits: ``vel_min``, ``vel_max`` and ``acce`` of each control.
    """

    index: int
    record: ObjectRecord
    static: bool
    kinematics: str | None
    behavior: str | None
    options: dict[str, Any]
    pose: tuple[float, float, float]
    goals: list[list[float]]
    footprint: Any
    radius: float | None
    box: Box | None
    extent: tuple[float, float]
    ranges: dict[str, float]
    avoided: str | None
    sensors: list[dict[str, Any]]
    color: str | None
    limits: dict[str, list[float]] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Its name."""
        return self.record.name

    @property
    def entry(self) -> str:
        """Path of its entry in the file."""
        return format_path(self.record.path)

    @property
    def role(self) -> str:
        """``robot`` or ``obstacle``."""
        return self.record.role

    @property
    def passable(self) -> bool:
        """Whether others pass through it (``unobstructed``)."""
        return self.record.unobstructed

    @property
    def position(self) -> tuple[float, float]:
        """Where it is: the middle of its footprint for a static object, else the origin of its frame."""
        if self.static:
            middle = self.footprint.centroid
            return float(middle.x), float(middle.y)
        return self.pose[0], self.pose[1]

    @property
    def goal(self) -> list[float] | None:
        """Its last goal."""
        return self.goals[-1] if self.goals else None

    @property
    def slowest(self) -> float:
        """Least forward speed that its limits allow [m/s]; negative where it may go backwards."""
        return self.limits["vel_min"][0] if self.limits["vel_min"] else 0.0

    @property
    def shape(self) -> str:
        """``circle``, ``square``, ``rectangle``, ``line``, ``polygon`` or ``compound``, whatever the file calls it."""
        if self.radius is not None:
            return "circle"
        if self.box is not None:
            if self.box.width == 0:
                return "line"
            return "square" if math.isclose(self.box.length, self.box.width, rel_tol=0.02) else "rectangle"
        if self.footprint.geom_type == "Polygon":
            return "polygon"
        return "line" if self.footprint.area == 0 else "compound"


def body_of(view: ObjectView, scenario: ResolvedScenario) -> GradedBody:
    """The body of an object."""
    record: Any = view.record
    kinematics = None if record.static or record.kinematics is None else str(record.kinematics.name)
    options: Any = (record.active_behavior if record.joined else record.behavior) if kinematics else None
    acts = getattr(options, "local", options)
    given = not scenario.is_parked(record) and scenario.has_written_goal(record)
    low, high = view.vel_min[:, 0].tolist(), view.vel_max[:, 0].tolist()
    pose = tuple(view._simulation.state.initial_state(view.row)[:3].tolist())
    footprint = view.geometry if view._simulation.appeared[view.row] >= 0 else _footprint_at(view, pose)
    radius = view.radius if _is_disc(view) else None
    return GradedBody(
        index=view.index, record=record, kinematics=kinematics, pose=pose, footprint=footprint, radius=radius,
        static=record.static or kinematics is None or (record.role == "obstacle" and options is None),
        behavior=None if options is None else str(options.name),
        options={} if options is None else options.model_dump(mode="json"),
        goals=[goal[:, 0].tolist() for goal in view.goals] if given and kinematics else [],
        box=None if radius is not None else _box(footprint), extent=(view.length, view.width),
        ranges=_ranges(record.kinematics, low, high, acts) if kinematics else {},
        avoided=options.target_roles if getattr(acts, "avoids", False) else None,
        sensors=[{**sensor.model_dump(mode="json"), "name": sensor.name} for sensor in record.sensors],
        color=_color(record.color),
        limits={"vel_min": low, "vel_max": high, "acce": view.acce[:, 0].tolist()},
    )  # fmt: skip


def _footprint_at(view: ObjectView, pose: Any) -> Any:
    """The footprint of an object that comes into the world later, where it will be."""
    own = outline(view._simulation.state, view.row).shapely()
    turned = shapely.affinity.rotate(own, pose[2], origin=(0, 0), use_radians=True)
    return shapely.affinity.translate(turned, *pose[:2])


def _is_disc(view: ObjectView) -> bool:
    """Whether an object is a disc: a circle, or a compound of one."""
    parts = getattr(view.record.shape, "parts", ())
    return view.shape == "circle" or [part.name for part in parts] == ["circle"]


def _ranges(drive: Any, low: list[float], high: list[float], behavior: Any) -> dict[str, float]:
    """The greatest speeds, turn rates and steering angles that limits, a drive and a behavior allow to each side."""
    if not high:
        return {}
    speeds, turns = {"forward": high[0], "backward": -low[0]}, dict[str, float]()
    if drive.speeds == 2:
        speeds |= {"leftward": high[1], "rightward": -low[1]}
    if drive.steered:
        turns["steer_right"], turns["steer_left"] = drive.steering(low, high)
    elif drive.speeds and drive.turns:
        turns = {"turn_left": high[drive.speeds], "turn_right": -low[drive.speeds]}
    most = behavior.top_speed_of_its_own() if isinstance(behavior, BehaviorOptions) else math.inf
    ranges = {name: max(0.0, min(speed, most)) for name, speed in speeds.items()}
    ranges |= {name: max(0.0, turn) for name, turn in turns.items() if turn < math.inf}
    larger = {
        name: max(ranges[side] for side in sides if side in ranges)
        for name, sides in _SIDES.items()
        if any(side in ranges for side in sides)
    }
    return ranges | larger


def _color(color: Any) -> str | None:
    from matplotlib.colors import to_hex

    if color is None:
        return None
    try:
        return str(to_hex(color))
    except ValueError:
        return str(color)


def _box(geometry: Any) -> Box | None:
    """The rectangle that a footprint is: a polygon with four right angles, or a straight line."""
    if geometry.geom_type not in ("Polygon", "LineString", "LinearRing"):
        return None
    hull = geometry.minimum_rotated_rectangle
    fits = hull.geom_type == "LineString"
    if hull.geom_type == geometry.geom_type == "Polygon":
        fits = shapely.symmetric_difference(hull, geometry).area <= _STRAIGHT * max(1.0, hull.length)
    if not fits:
        return None
    sides = [*np.diff(shapely.get_coordinates(hull)[:3], axis=0), np.zeros(2)]  # of a line only the first has a length
    long, short = sorted(sides[:2], key=lambda side: -np.hypot(*side))
    heading = math.atan2(long[1], long[0]) % math.pi
    return Box(math.hypot(*long), float(np.hypot(*short)), heading, (hull.centroid.x, hull.centroid.y))
