"""One entry of ``robot`` or ``obstacle``: a group of objects that share their keys."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from irsim._options import Options
from irsim.angles import SpanAngle
from irsim.behaviors._options import CustomOptions
from irsim.colors import ObjectColor
from irsim.registry import (
    BEHAVIORS,
    CUSTOM_BEHAVIORS,
    CUSTOM_GROUP_BEHAVIORS,
    DISTRIBUTIONS,
    KINEMATICS,
    SENSORS,
    SHAPES,
)
from irsim.scenario.plot import ObjectPlot
from irsim.selection import Select
from irsim.units import Bool, Meters, Number
from irsim.vectors import OrNull, PerObject, Pose, Range, Vector, vector

__all__ = ["Entry"]

Text = Annotated[str, Field(strict=True)]
Numbers = list[Number]
Unbounded = Annotated[float, Field(strict=True, ge=0)]  # infinity is fine, NaN is not
KinematicsField = Annotated[Any, Select(KINEMATICS, default="static", folded=True, null=True, empty=True), PerObject()]
ShapeField = Annotated[Any, Select(SHAPES, default="circle", folded=True, null=True), PerObject()]
BehaviorField = Annotated[
    Any, Select(BEHAVIORS, custom=CUSTOM_BEHAVIORS, fallback=CustomOptions, null=True, empty=True), PerObject()
]
GroupBehaviorField = Annotated[
    Any, Select(BEHAVIORS, custom=CUSTOM_GROUP_BEHAVIORS, fallback=CustomOptions, null=True, empty=True), PerObject()
]
SensorField = Annotated[Any, Select(SENSORS, default="lidar2d", alias="type")]
Control = Annotated[Numbers, vector(("control units",) * 3, 1, None)]


class Entry(Options):
    """One or several objects (`number`) that share these keys."""

    number: Annotated[int, Field(strict=True, ge=0)] = 1
    """How many objects this entry makes."""
    distribution: Annotated[Any, Select(DISTRIBUTIONS, null=True)] = None
    """How they are placed; null is `manual`: by `state` and `goal`."""
    name: Annotated[Text | None, PerObject()] = None
    """Unique name; null is `<role>_<id>`."""
    tags: Annotated[list[Text], PerObject("list")] = []
    """Free words; `pedestrian` is what metrics count as human."""
    role: Literal["robot", "obstacle"] | None = None
    """The section's own name; accepted because it is documented."""
    state: Annotated[Vector | None, PerObject()] = None
    """Initial state [x, y, theta, ...]; null is [1, 1, 0]. Missing numbers are zero, surplus ones are dropped."""
    goal: Annotated[Annotated[Pose, PerObject()] | None, PerObject()] = None
    """Goal [x, y] or [x, y, theta]; null is [1, 9, 0]. A list of vectors is one goal per object; waypoints take
    three levels of brackets, or `waypoints`."""
    waypoints: Annotated[Annotated[list[Pose], Field(min_length=1)], PerObject("path")] | None = None
    """Goals to visit one after the other: [[x, y], [x, y, theta], ...]."""
    velocity: Annotated[Vector | None, PerObject()] = None
    """Initial control; null is zero."""
    kinematics: KinematicsField = None
    """How it moves; null never moves."""
    shape: ShapeField = None
    """Its footprint; null is a circle of radius 1 m."""
    behavior: BehaviorField = None
    """What it does when nobody commands it."""
    group_behavior: GroupBehaviorField = None
    """What all members of its group do together; the first member's counts."""
    sensors: Annotated[list[SensorField], PerObject("list")] | None = None
    """Its sensors; the first lidar is its `lidar`."""
    plot: Annotated[ObjectPlot, PerObject()] = ObjectPlot()
    """How it is drawn."""
    color: Annotated[ObjectColor | None, PerObject()] = None
    """Its colour, or `cycle` for one palette colour after the other; null depends on role and drive."""
    description: Annotated[Text | None, PerObject()] = None
    """Picture drawn instead of the footprint: a bundled name or a file."""
    static: Annotated[Bool, OrNull(False)] = False
    """Never moves although it has kinematics."""
    vel_min: Annotated[Vector | None, PerObject()] = None
    """Lower limits of the control components; null is -1 each."""
    vel_max: Annotated[Vector | None, PerObject()] = None
    """Upper limits of the control components; null is 1 each."""
    acce: Annotated[list[Unbounded] | None, PerObject()] = None
    """Largest change of each control component per second; null is unlimited."""
    angle_range: Annotated[Range | None, PerObject()] = None
    """Interval of the heading, one turn wide; null is [-π, π]."""
    goal_threshold: Annotated[Meters, Field(ge=0)] = 0.1
    """Distance at which a goal counts as reached."""
    arrive_mode: Annotated[Literal["position", "state"], PerObject()] = "position"
    """What must match at the goal: the position, or the heading too."""
    group: Annotated[int, Field(strict=True)] | None = None
    """Group number; objects with the same number form a group. Null numbers the entries."""
    group_name: Annotated[Text | None, PerObject()] = None
    """Name of the group; null is `<role>_<group>`."""
    unobstructed: Annotated[Bool, OrNull(False)] = False
    """Others do not collide with it and lidars do not see it."""
    fov: SpanAngle | None = None
    """Opening angle of the field of view; null is the lidar's."""
    fov_radius: Annotated[Meters, Field(ge=0)] | None = None
    """Reach of the field of view; null is the lidar's."""
    fov_occlusion: Bool = False
    """Things hidden behind others are not in the field of view."""
    state_dim: Annotated[int, Field(strict=True, ge=3, le=64)] | None = None
    """Rows of the state; null is what the kinematics has. Surplus rows keep their value."""
    vel_dim: Annotated[int, Field(strict=True, ge=1, le=64)] | None = None
    """Components of the control; null is what the kinematics has."""
    mass: Annotated[Annotated[Unbounded, Field(gt=0, json_schema_extra={"x-unit": "kg"})] | None, PerObject("number")] = (
        None
    )
    """For `collision_mode: contact`; null is 1 with kinematics and infinite without."""
    friction: Annotated[
        Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "1"})] | None, PerObject("number")
    ] = None
    """Grip on the ground, for `collision_mode: contact`; null is the world's."""
    inertia: Annotated[
        Annotated[Unbounded, Field(gt=0, json_schema_extra={"x-unit": "kg m^2"})] | None, PerObject("number")
    ] = None
    """Resistance to turning, for `collision_mode: contact`; null follows from shape and mass."""
    restitution: Annotated[
        Annotated[Number, Field(ge=0, le=1, json_schema_extra={"x-unit": "1"})] | None, PerObject("number")
    ] = None
    """Bounciness, for `collision_mode: contact`; null is the world's."""
