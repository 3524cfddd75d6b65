"""Options that the components of a kind share: behaviors, drives, shapes, sensors, distributions, maps, bridges."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Annotated, Any, ClassVar, Literal, Protocol

from pydantic import ConfigDict, Field

import irsim._core as core
from irsim.options.base import Options
from irsim.options.knowledge import Fact
from irsim.options.units import MAX_VERTICES, Bool, Count, Integer, Meters, Number, Seconds
from irsim.options.vectors import Component, Point, Pose, vector

__all__ = [
    "MARGIN",
    "BehaviorOptions",
    "BridgeOptions",
    "CustomKinematics",
    "CustomOptions",
    "DistributionOptions",
    "Drawn",
    "GridPlanner",
    "KinematicsOptions",
    "MapOptions",
    "PlannerOptions",
    "RandomOutline",
    "SamplingPlanner",
    "SensorOptions",
    "ShapeOptions",
    "WorldExtent",
    "behavior_fields",
    "opened_by",
    "random_polygon",
]


class BehaviorOptions(Options):
    """Keys that every behavior takes."""

    in_group: ClassVar[bool] = False
    """Whether it may be named under `group_behavior`: it decides for all members at once."""
    avoids: ClassVar[bool] = False
    """Whether it avoids other objects."""
    touches: ClassVar[bool] = False
    """Whether bodies that it moves touch others now and then."""
    stops_in_time: ClassVar[bool] = False
    """Whether it stops before what stands with any `timeHorizonObst`."""
    needs_goal: ClassVar[bool] = True
    """Whether it drives to the goal: without a `goal` of its own an object gets a hint."""
    follows_paths: ClassVar[bool] = True
    """Whether `follow` may name it as `local`, which drives along a path."""
    knows: ClassVar[frozenset[Fact]] = frozenset()
    """Its information besides its own state and goal; a test changes everything else and expects equal decisions."""

    name: str
    """Name of the behavior."""
    wander: Bool = False
    """Drive to random goals between `range_low` and `range_high`; each object draws its next at each arrival."""
    loop: Bool = False
    """After the last goal, start again with the first; with one goal, shuttle between it and the start. `wander` takes
    precedence."""
    range_low: Pose | None = None
    """Lower corner of random goals, for the middle of the object; null is the world's own, where bodies at the edge
    reach beyond. Two numbers leave the heading free."""
    range_high: Pose | None = None
    """Upper corner of random goals, as `range_low`; null is the world's own."""
    target_roles: Literal["all", "robot", "obstacle"] = "all"
    """Role of the objects that it reacts to: with `robot` it does not avoid people who are obstacles, with `obstacle`
    no robots."""

    def known(self) -> frozenset[Fact]:
        """Its information with these options."""
        return self.knows

    def draws(self) -> bool:
        """Whether its decisions draw random numbers, so that they depend on the seed."""
        return False

    def top_speed_of_its_own(self) -> float:
        """Limit of speed among its own keys [m/s]; infinity without one."""
        most = getattr(self, "maxSpeed", None)
        return math.inf if most is None else float(most)


class CustomOptions(BehaviorOptions):
    """A behavior registered by user code: its own keys reach the registered function as they are."""

    model_config = ConfigDict(extra="allow")


def behavior_fields(options: Any, bounds: tuple[float, float, float, float]) -> dict[str, Any]:
    """The fields of an object that follow from the options of its behavior.

    Args:
        options: The options; None without a behavior.
        bounds: x0, y0, x1, y1 of the world [m], the default range of random goals.
    """
    x0, y0, x1, y1 = bounds
    low = getattr(options, "range_low", None) or [x0, y0]
    high = getattr(options, "range_high", None) or [x1, y1]
    return {
        "wander": getattr(options, "wander", False),
        "loop": getattr(options, "loop", False),
        "range_low": [*low, -math.pi][:3],
        "range_high": [*high, math.pi][:3],
        "target_roles": getattr(options, "target_roles", "all"),
    }


class KinematicsOptions(Options):
    """Keys that every drive takes."""

    any_case: ClassVar[bool] = True

    state_rows: ClassVar[tuple[str, ...]] = ("x", "y", "theta")
    """Names of the state rows."""
    control_rows: ClassVar[tuple[str, ...]] = ("linear", "angular")
    """Names of the control components, in the order of ``vel_max``, ``velocity`` and actions. Checks of units look for
    ``angular``, ``yaw``, ``steer`` and ``lateral`` in them."""
    control_units: ClassVar[tuple[str, ...]] = ("m/s", "rad/s")
    speeds: ClassVar[int] = 0
    """Number of leading controls that are speeds of the body: 1 is forward, 2 are forward and sideways. It is 0 if
    unknown, as for drives of user code: nothing is then checked about their limits."""
    turns: ClassVar[bool] = True
    """Whether a control changes the heading."""
    steered: ClassVar[bool] = False
    """Whether the second control steers wheels: the heading changes only while they roll, and the wheelbase matters."""
    pivots: ClassVar[bool] = False
    """Whether its steered wheel may stand at a quarter turn, so that it turns on the spot."""
    slips: ClassVar[bool] = False
    """Whether the body moves otherwise than its controls say, such as wheels that slip or that need time."""
    feels: ClassVar[tuple[str, ...]] = ()
    """The changes by the ground of a zone: `slip`, `grip` or `surface`. Drives of user code feel none of it."""
    coasts: ClassVar[bool] = False
    """Whether its speeds are states of their own, which need time to change; contacts cannot push such a body."""
    usual_vel_max: ClassVar[tuple[float, ...]] = ()
    usual_vel_min: ClassVar[tuple[float, ...]] = ()
    usual_acce: ClassVar[tuple[float, ...]] = ()
    """Limits if a scenario gives none; empty means 1, -1 and infinity, in this order, for each control."""
    usual_colors: ClassVar[tuple[str, str] | None] = None
    """Colours of robots and obstacles if a scenario gives none; None means the common colours."""
    picture: ClassVar[str | None] = None
    """Image that robots are drawn with if a scenario gives none."""
    arrow: ClassVar[bool] = True
    """Whether the heading is drawn if a scenario does not say."""

    name: str
    """Name of the drive, which is the motion model."""
    noise: Bool = False
    """Add Gaussian noise to the executed velocity, drawn in each step for each object."""
    mode: str | None = None
    """Only drives that steer use it; the other ones accept and ignore it."""
    tau: Annotated[Seconds, Field(ge=0)] | None = None
    """Lag of the drive in `collision_mode: contact`; null is `world.drive_tau`."""
    wheelbase: Annotated[Meters, Field(ge=0)] | None = None
    """Distance between the axles for the motion model; null is the `wheelbase` of the shape."""

    def steering(self, low: Sequence[float], high: Sequence[float]) -> tuple[float, float]:
        """Largest steering angles to the right and to the left [rad], of a drive that steers wheels.

        Args:
            low: Lower limits of its controls, ``vel_min``.
            high: Upper limits, ``vel_max``.
        """
        return max(0.0, -low[1]), max(0.0, high[1])


class CustomKinematics(KinematicsOptions):
    """A drive registered by user code: its own keys reach the registered function as they are."""

    model_config = ConfigDict(extra="allow")


class ShapeOptions(Options):
    """A footprint in the body frame: the origin is the object's position, +x its heading."""

    any_case: ClassVar[bool] = True

    name: str
    """Name of the shape."""
    wheelbase: Annotated[Meters, Field(ge=0)] | None = None
    """Distance between the axles of a drive that steers; rectangles and circles then have their origin at the rear
    axle."""


Vertices = Annotated[Integer, Field(ge=3, le=1000)]


class RandomOutline(ShapeOptions):
    """Parameters of randomly drawn vertices."""

    vertices: Annotated[list[Point], Field(max_length=MAX_VERTICES)] | None = None
    """Corners in the body frame, used as given; the object's `state` moves and turns them."""
    random_shape: Bool = False
    """Draw random vertices for every scene instead; with `number`, each object has its own."""
    center_range: Annotated[list[Component], vector(("m", "m", "m", "m"), 4)] = [0.0, 0.0, 0.0, 0.0]
    """Range of the middle of a random outline, body frame: [xmin, ymin, xmax, ymax]."""
    avg_radius_range: Annotated[list[Annotated[Component, Field(ge=0)]], vector(("m", "m"), 2)] = [0.1, 1.0]
    """Range of the mean distance of the vertices from the middle."""
    irregularity_range: Annotated[list[Annotated[Component, Field(ge=0, le=1)]], vector(("1", "1"), 2)] = [0.0, 1.0]
    """Range of the unevenness of the angles between vertices: 0 is even, 1 very uneven."""
    spikeyness_range: Annotated[list[Annotated[Component, Field(ge=0, le=1)]], vector(("1", "1"), 2)] | None = None
    """Range of the variation of distances from the middle (0: no variation); null is [0, 1], or [0, 0] if convex."""
    num_vertices_range: Annotated[list[Vertices], vector(("1", "1"), 2)] = [4, 10]
    """Range of the number of vertices: the smallest number, and one more than the largest."""
    number: Annotated[Integer, Field(ge=1, le=1)] = 1
    """Number of outlines per object, which is always 1."""


def random_polygon(options: RandomOutline, convex: bool, closed: bool) -> core.RandomPolygon:
    """The core's random polygon for these parameters."""
    spikeyness = options.spikeyness_range
    return core.RandomPolygon(
        center_range=options.center_range,
        avg_radius_range=options.avg_radius_range,
        irregularity_range=options.irregularity_range,
        spikeyness_range=spikeyness if spikeyness is not None else [0.0, 0.0] if convex else [0.0, 1.0],
        num_vertices_range=options.num_vertices_range,
        closed=closed,
    )


class SensorOptions(Options):
    """A sensor on an object."""

    is_lidar: ClassVar[bool] = False
    """Whether the first such sensor becomes the object's ``lidar``."""

    name: str
    """Name of the sensor."""
    type: str | None = None
    """Another key for the name, used if `name` is missing."""


MARGIN = 0.5
"""Distance of drawn places from the edge of the world [m], unless the options say where they are."""


class DistributionOptions(Options):
    """How the objects of one entry are placed."""

    name: str
    """Name of the distribution."""


class WorldExtent(Protocol):
    """World data that a distribution may use: size [m] and middle."""

    @property
    def width(self) -> float:
        """Extent along x [m]."""

    @property
    def height(self) -> float:
        """Extent along y [m]."""

    @property
    def center(self) -> tuple[float, float]:
        """x, y of the middle [m]."""

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max [m]."""


@dataclass(frozen=True)
class Drawn:
    """Where a distribution with a kernel draws places.

    Attributes:
        low: Smallest x [m], y [m] and heading [rad] of a place, world frame.
        high: Greatest x, y and heading.
        min_distance: Smallest distance between the positions of its objects that the options ask for [m].
        kernel: Fields of the kernel, without the objects and the number of attempts.
        clear_of: Names of the objects and groups that its objects keep clear of, and how far from each [m].
    """

    low: list[float]
    high: list[float]
    min_distance: float
    kernel: Mapping[str, Any]
    clear_of: Sequence[tuple[str, float]] = ()


class PlannerOptions(Options):
    """Plan a path on the map inflated by the footprint."""

    name: str
    """Name of the planner."""


class GridPlanner(PlannerOptions):
    """Plans on the cells of a grid."""

    resolution: Annotated[Meters, Field(gt=0)] | None = None
    """Cell size of the grid; null is the map's (`follow`: above 2,500 m^2), else 0.1 m."""


class SamplingPlanner(PlannerOptions):
    """Plans with random samples, drawn from the planner stream of the environment."""

    expand_dis: Annotated[Meters, Field(gt=0)] = 1.0
    """Longest extension of the tree."""
    path_resolution: Annotated[Meters, Field(gt=0)] = 0.25
    """Extensions end at its multiples, checked all along."""
    goal_sample_rate: Annotated[Number, Field(ge=0, le=100)] = 5.0
    """Share of samples placed at the goal, in percent."""
    max_iter: Annotated[Count, Field(le=100_000)] = 500
    """Largest number of samples."""


class MapOptions(Options):
    """Where the occupancy grid of the world comes from."""

    name: str
    """Name of the generator."""


class BridgeOptions(Options):
    """A connection to another program."""

    files: ClassVar[tuple[str, ...]] = ()
    """Keys that name files or folders to write."""

    objects: ClassVar[tuple[str, ...]] = ()
    """Keys that name objects of the scenario."""
    robots_only: ClassVar[tuple[str, ...]] = ()
    """The keys among these that name robots."""

    name: str
    """Name of the bridge."""
    clock: Literal["irsim", "external", "wall"] = "irsim"
    """Who decides when a step is: `irsim` steps as fast as it can and the other program follows, `external` waits for
    the other program before each step, `wall` steps in real time."""

    def driven(self, robots: Sequence[str]) -> Sequence[str]:
        """Which of the robots with these names the other program may drive by commands."""
        return ()


def opened_by(package: str) -> Callable[[Any], Any]:
    """Function that makes the bridge of some options: ``make`` of ``irsim.bridges.<package>.bridge``.

    The module is imported when the bridge is opened, because it may need libraries that few users have.
    """

    def opened(options: Any) -> Any:
        return import_module(f"irsim.bridges.{package}.bridge").make(options)

    return opened
