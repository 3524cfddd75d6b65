"""``carla``: pedestrians and robots of a scenario in a town of CARLA."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from irsim.components.options import BridgeOptions, opened_by
from irsim.options.base import Options, problem
from irsim.options.registry import BRIDGES
from irsim.options.units import Bool, Degrees, Integer, Meters, Seconds

Name = Annotated[str, Field(strict=True, min_length=1)]


class Placement(Options):
    """Where the origin of the scenario is in the town, in the numbers that CARLA shows."""

    x: Meters = 0.0
    """x of CARLA."""
    y: Meters = 0.0
    """y of CARLA, which points to the right of x."""
    yaw: Degrees = 0.0
    """Direction of the x axis of the scenario, clockwise seen from above, as a rotation of CARLA has it."""


class CarlaLidar(Options):
    """Lidars of CARLA on robots, whose points become the scans that policies see."""

    robots: list[Name] | None = None
    """Robots with CARLA's lidars; null is all robots in the town that have a lidar."""
    height: Meters = 1.0
    """Height of the sensor above the ground."""
    low: Meters = 0.2
    """Points nearer to the ground than this are not seen, as they are the ground."""
    high: Meters = 2.0
    """Points higher above the ground than this are not seen."""
    channels: Annotated[Integer, Field(ge=1, le=256)] = 1
    """Number of rays above each other; a scan has the nearest point of them."""
    upper: Annotated[Degrees, Field(ge=-90, le=90)] = 0.0
    """Elevation of the highest ray, or of the only one."""
    lower: Annotated[Degrees, Field(ge=-90, le=90)] = 0.0
    """Elevation of the lowest ray."""
    points: Annotated[Integer, Field(ge=16, le=100_000)] | None = None
    """Points of a ray in a full turn; null is four for each beam of the scan."""
    dropoff: Bool = False
    """Let CARLA leave out weak reflections, and points at random, as it does by default."""

    def model_post_init(self, context: Any) -> None:
        """Check what keys mean together."""
        if self.low >= self.high:
            raise problem(
                "invalid-value", f"low must be below high, got {self.low:g} and {self.high:g}", fix="low: 0.2"
            )
        if self.lower > self.upper:
            what = f"lower must not be above upper, got {self.lower:g} and {self.upper:g}"
            raise problem("invalid-value", what, fix=f"lower: {self.upper:g}")


class Carla(BridgeOptions):
    """Show the scenario in a running CARLA server, or let vehicles of CARLA be robots of the scenario.

    Pedestrians walk as the scenario moves them, vehicles drive by their commands, and lidars of CARLA become scans of
    robots. CARLA runs in synchronous mode; its settings are restored, and all actors destroyed, at the end.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"name": "carla", "transform": {"x": 80.0, "y": 30.0, "yaw": 90.0}},
            {"name": "carla", "vehicles": ["car"], "command": "ackermann", "lidar": {"height": 1.8}},
        ]
    }

    objects: ClassVar[tuple[str, ...]] = ("walkers", "vehicles", "follow")

    name: Literal["carla"] = "carla"
    clock: Literal["irsim", "external"] = "irsim"
    """Who ticks CARLA: `irsim`, at least once in each step; with `external` another client, which irsim waits for."""
    host: Name = "127.0.0.1"
    """Computer on which the server runs."""
    port: Annotated[Integer, Field(ge=1, le=65534)] = 2000
    """Port of the server; the next one is used as well."""
    timeout: Annotated[Seconds, Field(gt=0, le=3600)] = 10.0
    """Time for which irsim waits for an answer of the server. A large town takes long to load."""
    town: Name | None = None
    """Name of the town that the server must have loaded, such as `Town03`; null is any."""
    any_version: Bool = False
    """Go on although client and server have different versions, which may end in errors of the client."""
    transform: Placement = Placement()
    """Where the origin of the scenario is in the town."""
    ground: Literal["project", "road"] | Meters = "project"
    """Height of the ground: where a ray from above hits, at the nearest road, or one number for all places."""
    walkers: list[Name] | None = None
    """Objects that are pedestrians; null is all that can move and are neither vehicles nor followed."""
    vehicles: list[Name] | None = None
    """Objects that are vehicles; null is all whose drive steers wheels, such as `acker`."""
    follow: dict[Name, Name | Annotated[Integer, Field(ge=1)]] = {}
    """Objects that follow existing actors: the name of the object, and the `role_name` or the id of an actor that is in
    the town already."""
    walker_blueprint: Name = "walker.pedestrian.*"
    """Blueprints of pedestrians, a name or a pattern; pedestrians take turns."""
    vehicle_blueprint: Name = "vehicle.tesla.model3"
    """Blueprints of vehicles, a name or a pattern."""
    command: Literal["ackermann", "velocity", "transform"] = "ackermann"
    """How vehicles move. With `ackermann` (speed and steering angle) and `velocity` CARLA moves them and the scenario
    has them where CARLA does; with `transform` the scenario moves them, and CARLA only shows them."""
    wheelbase: Annotated[Meters, Field(gt=0)] | None = None
    """Distance between the axles of the vehicle in CARLA, for steering angles; null is the robot's."""
    correction: Annotated[Meters, Field(gt=0)] = 0.3
    """A pedestrian that is farther than this from where it should be is put there instead of walking there."""
    lidar: CarlaLidar | None = None
    """Lidars of CARLA, `{}` for the usual ones; null leaves the scans to irsim."""
    tick: Annotated[Seconds, Field(gt=0, le=1)] | None = None
    """Period of CARLA, of which a step has a whole number; null is the longest up to 0.1 s, the most that its physics
    takes with its own settings."""
    rendering: Bool = True
    """Draw the town; without, a server is faster and shows nothing."""

    def driven(self, robots: Sequence[str]) -> Sequence[str]:
        """Objects that follow actors."""
        return tuple(self.follow)


BRIDGES.register(Carla)(opened_by("carla"))
