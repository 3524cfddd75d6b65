"""``detector``: the knowledge of a robot about other moving objects: detections, mistakes, and tracks."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.sensors._gauges import GaugeOptions
from irsim.options.registry import SENSORS
from irsim.options.units import Bool, Fraction, Integer, Meters, MetersPerSecond, Number, Seconds, SpanAngle
from irsim.options.vectors import Offset

PerSecond = Annotated[Number, Field(ge=0, le=1000, json_schema_extra={"x-unit": "1/s"})]


class Detector(GaugeOptions):
    """Detector of people and robots with the tracker behind it: it misses some, and sees what is not there.

    A step, or a measurement of its `rate`, detects an object in view with `probability`, which falls to its half at
    `half_range`. A track goes on for `keep` seconds without detections, at its last velocity. With `perceives: tracks`
    behaviors and policies decide from the tracks; a false track then takes the place and the shape of an object that is
    not seen.
    """

    locates: ClassVar[bool] = True
    table: ClassVar[str] = "tracks"
    reports: ClassVar[tuple[str, ...]] = ("id", "x", "y", "vx", "vy", "radius", "object")
    report_units: ClassVar[tuple[str, ...]] = ("1", "m", "m", "m/s", "m/s", "m", "1")
    also_called: ClassVar[dict[str, str]] = {"angle": "angle_range", "fov": "angle_range", "range": "range_max"}
    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"name": "detector", "range_max": 8, "probability": 0.9, "position_std": 0.05, "keep": 0.5}]
    }

    name: Literal["detector"] = "detector"
    offset: Offset = [0.0, 0.0, 0.0]
    """Place in the body frame: [x, y, theta]."""
    range_max: Annotated[Meters, Field(gt=0)] = 10.0
    """Reach."""
    angle_range: SpanAngle = 6.283185307179586
    """Full opening angle."""
    targets: Literal["all", "robot", "obstacle"] = "all"
    """Role of the moving objects that it looks for."""
    probability: Fraction = 1.0
    """Probability of a detection in a step or a measurement, near and in full sight."""
    half_range: Annotated[Meters, Field(ge=0)] = 0.0
    """Distance at which the probability has fallen to its half; 0: it does not fall."""
    range_softness: Annotated[Meters, Field(ge=0)] = 0.5
    """How gently it falls there (logistic)."""
    occlusion: Bool = True
    """Whether what stands or moves between hides an object."""
    min_visible: Fraction = 0.3
    """Share of its outline that must be in sight."""
    position_std: Annotated[Meters, Field(ge=0)] = 0.0
    """Standard deviation of each coordinate."""
    velocity_std: Annotated[MetersPerSecond, Field(ge=0)] = 0.0
    """Standard deviation of each coordinate of the velocity."""
    false_tracks: PerSecond = 0.0
    """How many tracks of nothing begin in a second, on average, anywhere in view."""
    false_radius: Annotated[Meters, Field(gt=0)] = 0.3
    """Radius of what they seem to be."""
    id_switches: PerSecond = 0.0
    """How often, on average, the two tracks that are nearest to each other take each other's id."""
    keep: Annotated[Seconds, Field(ge=0)] = 0.5
    """Time for which a track goes on without detections; with a `rate` more than 1 / `rate`, or each
    measurement begins new tracks."""
    max_tracks: Annotated[Integer, Field(ge=1, le=1000)] = 20
    """Largest number of tracks; nearer ones replace the farthest."""


SENSORS.register(Detector, kernel=core.DetectorOptions)
