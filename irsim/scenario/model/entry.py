"""One entry of ``robot`` or ``obstacle``: a group of objects that share their keys."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.options import CustomOptions
from irsim.options.base import Options
from irsim.options.colors import ObjectColor
from irsim.options.registry import (
    BEHAVIORS,
    CUSTOM_BEHAVIORS,
    CUSTOM_GROUP_BEHAVIORS,
    DISTRIBUTIONS,
    KINEMATICS,
    SENSORS,
    SHAPES,
)
from irsim.options.selection import Select
from irsim.options.units import Bool, Fraction, Integer, Meters, Number, Seconds, SpanAngle
from irsim.options.vectors import Component, OrNull, PerObject, Pose, Range
from irsim.scenario.model.actuation import Actuation
from irsim.scenario.model.plot import ObjectPlot

__all__ = ["Entry"]

Text = Annotated[str, Field(strict=True)]
Unbounded = Annotated[float, Field(strict=True, ge=0)]  # infinity is fine, NaN is not
State = Annotated[list[Component], Field(max_length=64, json_schema_extra={"x-units": ["m", "m", "rad"]})]
_Sizes = Field(min_length=1, max_length=64)
Control = Annotated[list[Component], _Sizes, Field(json_schema_extra={"x-unit": "control units"})]
Rates = Annotated[list[Unbounded], _Sizes, Field(json_schema_extra={"x-unit": "control units / s"})]
Group = Annotated[Integer, Field(ge=-(10**9), le=10**9)]
Waypoints = Annotated[list[Pose], Field(min_length=1, max_length=100_000)]
Mass = Annotated[float, Field(strict=True, gt=0, json_schema_extra={"x-unit": "kg"})]
Inertia = Annotated[float, Field(strict=True, gt=0, json_schema_extra={"x-unit": "kg m^2"})]
Delay = Annotated[Seconds, Field(ge=0)]
Grip = Annotated[Number, Field(ge=0, json_schema_extra={"x-unit": "1"})]
KinematicsField = Annotated[Any, Select(KINEMATICS, default="static", folded=True, null=True, empty=True)]
ShapeField = Annotated[Any, Select(SHAPES, default="circle", folded=True, null=True)]
BehaviorField = Annotated[
    Any, Select(BEHAVIORS, custom=CUSTOM_BEHAVIORS, fallback=CustomOptions, null=True, empty=True)
]
GroupBehaviorField = Annotated[
    Any,
    Select(BEHAVIORS, custom=CUSTOM_GROUP_BEHAVIORS, fallback=CustomOptions, null=True, empty=True, trait="in_group"),
]
SensorField = Annotated[Any, Select(SENSORS, default="lidar2d", alias="type")]


class Entry(Options):
    """One or several objects (`number`) that share these keys."""

    also_called: ClassVar[dict[str, str]] = {
        "pose": "state",
        "start": "state",
        "position": "state",
        "initial_state": "state",
        "target": "goal",
        "destination": "goal",
        "path": "waypoints",
        "route": "waypoints",
        "drive": "kinematics",
        "model": "kinematics",
        "footprint": "shape",
        "controller": "behavior",
        "policy": "behavior",
        "sensor": "sensors",
        "lidar": "sensors",
        "count": "number",
        "max_speed": "vel_max",
        "max_velocity": "vel_max",
        "acceleration": "acce",
        "actuator": "actuation",
        "actuators": "actuation",
        "perception": "perceives",
        "tolerance": "goal_threshold",
        "goal_tolerance": "goal_threshold",
        "xy_goal_tolerance": "goal_threshold",
        "goal_radius": "goal_threshold",
        "delay": "start_time",
        "start_delay": "start_time",
        "departure": "start_time",
        "departure_time": "start_time",
        "depart": "start_time",
        "t_start": "start_time",
        "spawn_time": "appear_time",
        "appears": "appear_time",
        "appears_at": "appear_time",
        "enter_time": "appear_time",
        "entry_time": "appear_time",
    }
    schema_extra: ClassVar[dict[str, Any]] = {
        "not": {
            "required": ["goal", "waypoints"],
            "properties": {"goal": {"not": {"type": "null"}}, "waypoints": {"not": {"type": "null"}}},
        }
    }

    number: Annotated[Integer, Field(ge=0)] = 1
    """Number of objects that this entry makes. A random value, as of a start or a shape, is drawn for each of them; a
    list gives one value to each, and a single value goes to all."""
    distribution: Annotated[Any, Select(DISTRIBUTIONS, null=True)] = None
    """How the objects are placed; null is `manual`: by `state` and `goal`."""
    name: Annotated[Any, PerObject(Text | None)] = None
    """Unique name; null is `<role>_<id>`."""
    tags: Annotated[Any, PerObject(list[Text], "list")] = []
    """Free words; metrics count objects with the tag `pedestrian` as humans."""
    role: Literal["robot", "obstacle"] | None = None
    """Name of the section that the entry is in; it is not needed."""
    state: Annotated[Any, PerObject(State | None, "vector")] = None
    """Initial state [x, y, theta, ...]; null is [1, 1, 0]. Missing numbers are zero, surplus ones are dropped."""
    goal: Annotated[Any, PerObject(Annotated[Any, PerObject(Pose, "vector")] | None, "vector")] = None
    """Goal [x, y] or [x, y, theta]; null is [1, 9, 0]. A list of vectors is one goal per object; several goals for
    each object go under `waypoints`, or need three levels of brackets."""
    waypoints: Annotated[Any, PerObject(Waypoints | None, "path")] = None
    """Goals to visit one after the other: [[x, y], [x, y, theta], ...]."""
    start_time: Annotated[Any, PerObject(Delay, "number")] = 0.0
    """Time from which the object moves. Until then it stands at its start, where others see it and collide with it,
    and follows neither its behavior nor commands. A list of numbers is one time per object."""
    appear_time: Annotated[Any, PerObject(Delay, "number")] = 0.0
    """Time at which the object comes into the world. Until then it does not exist for sensors, other objects and
    pictures, and its x and y are NaN. If its place is taken then, it waits until there is room. A list of numbers is
    one time per object."""
    velocity: Annotated[Any, PerObject(Control | None, "vector")] = None
    """Initial control; null is zero."""
    kinematics: Annotated[Any, PerObject(KinematicsField)] = None
    """Drive of the object; null is an object that never moves."""
    shape: Annotated[Any, PerObject(ShapeField)] = None
    """Footprint of the object; null is a circle of radius 1 m."""
    behavior: Annotated[Any, PerObject(BehaviorField)] = None
    """How the object decides where to move when no program commands it."""
    group_behavior: Annotated[Any, PerObject(GroupBehaviorField)] = None
    """Behavior that decides for all members of a group together; the one of its first member counts."""
    sensors: Annotated[Any, PerObject(list[SensorField] | None, "list")] = None
    """Sensors of the object; programs find the first lidar as `lidar`."""
    plot: Annotated[Any, PerObject(ObjectPlot)] = ObjectPlot()
    """How the object is drawn."""
    color: Annotated[Any, PerObject(ObjectColor | None)] = None
    """Colour, or `cycle` for a different palette colour per object; null is a colour by role and drive."""
    description: Annotated[Any, PerObject(Text | None)] = None
    """Picture drawn instead of the footprint: a bundled name or a file; null is a green car for `acker`, and an empty
    text the plain footprint in `color`."""
    static: Annotated[Bool, OrNull(False)] = False
    """The object never moves, although it has kinematics."""
    vel_min: Annotated[Any, PerObject(Control | None, "vector")] = None
    """Lower limits of the controls, in the order of `vel_max`; null is -1 each. If the first number is 0,
    the object cannot reverse."""
    vel_max: Annotated[Any, PerObject(Control | None, "vector")] = None
    """Upper limits of the controls, such as top speed and turn rate; null is 1 each.

    diff: [m/s, rad/s]; omni: [forward, sideways] m/s; omni_angular: [m/s, m/s, rad/s]; acker: [m/s, steering rad].
    """
    acce: Annotated[Any, PerObject(Rates | None, "vector")] = None
    """Largest change of each control component per second; null is unlimited."""
    actuation: Annotated[Any, PerObject(Actuation | None)] = None
    """The way of commands to the drive that executes them, in this order: `command_period`, `delay`, `resolution`,
    limits with `jerk`, `lag`, `dead_band`, `noise`. Null executes them at once, within `vel_min`, `vel_max` and `acce`.
    """
    perceives: Annotated[Any, PerObject(Literal["truth", "estimate", "tracks", "both"])] = "truth"
    """The knowledge from which behaviors and policies decide. `estimate`: the pose that the object's `localization`
    reports, or else its `odometry`; goals, routes, zones and what stands are where its map has them, and it rests
    within half of `goal_threshold` of where it believes its goal to be. `tracks`: the tracks of its `detector` instead
    of the other moving objects. `both`: these two. Outcomes, collisions and rewards stay true."""
    angle_range: Annotated[Any, PerObject(Range | None, "vector")] = None
    """Interval of the heading, one turn wide; null is [-π, π]."""
    goal_threshold: Annotated[Meters, Field(ge=0)] = 0.1
    """A goal counts as reached when it is nearer than this. With `arrive_mode: state` the heading counts too:
    sqrt(dx^2 + dy^2 + turn^2), in metres and radians, must be below it, so 0.15 means under 0.15 m and under 0.15 rad
    (8.6 degrees), and less of each if both are off."""
    arrive_mode: Annotated[Any, PerObject(Literal["position", "state"])] = "position"
    """Required match at the goal: `position` alone, or `state`, which includes the heading that a goal of three
    numbers [x, y, heading] gives. `state` has no tolerance of its own: sqrt(dx^2 + dy^2 + turn^2), in metres and
    radians, must be below `goal_threshold`, so 0.1 allows at most 0.1 rad. `diff` and `omni_angular` turn to it at
    their goal under every built-in behavior, and a car comes in with it under `follow`."""
    group: Group | None = None
    """Group number; objects with the same number form a group. Null gives each entry a number of its own."""
    group_name: Annotated[Any, PerObject(Text | None)] = None
    """Name of the group; null is `<role>_<group>`."""
    unobstructed: Annotated[Bool, OrNull(False)] = False
    """Other objects do not collide with this one and lidars do not see it; it still collides with others."""
    reflectivity: Fraction | None = None
    """Share of the light of a lidar that the surface throws back, for lidars with `realism`; null is 0.8."""
    material: Literal["matt", "glass", "mirror"] = "matt"
    """How the surface treats the light of lidars with `realism`: `glass` returns beams that meet it within 10
    degrees of straight ahead and lets others pass, a `mirror` shows what it reflects, `matt` throws light in all
    directions."""
    fov: SpanAngle | None = None
    """Opening angle of the field of view; null is the lidar's. If it is given, events say when the object sees
    others: robots, objects that can move, and obstacles with `tags`."""
    fov_radius: Annotated[Meters, Field(ge=0)] | None = None
    """Reach of the field of view; null is the lidar's."""
    fov_occlusion: Bool = False
    """Objects hidden behind others are not in the field of view."""
    state_dim: Annotated[Integer, Field(ge=3, le=64)] | None = None
    """Number of state rows; null takes the number from the kinematics. Additional rows keep their values."""
    vel_dim: Annotated[Integer, Field(ge=1, le=64)] | None = None
    """Number of control components; null takes the number from the kinematics."""
    mass: Annotated[Any, PerObject(Mass | None, "number")] = None
    """Mass for `collision_mode: contact`; null is 1 with kinematics and infinite without."""
    friction: Annotated[Any, PerObject(Grip | None, "number")] = None
    """Coefficient of friction with the ground, for `collision_mode: contact`; null is the world's."""
    inertia: Annotated[Any, PerObject(Inertia | None, "number")] = None
    """Moment of inertia for `collision_mode: contact`; null follows from shape and mass."""
    restitution: Annotated[Any, PerObject(Fraction | None, "number")] = None
    """Coefficient of restitution (1 bounces fully), for `collision_mode: contact`; null is the world's."""
