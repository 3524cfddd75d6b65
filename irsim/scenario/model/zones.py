"""Zones: lines and areas of the world that are watched, and areas of other ground, under ``world.zones``."""

from __future__ import annotations

import math
from typing import Annotated, Any, ClassVar

from pydantic import Field

from irsim.components.kinematics._presets import Surface
from irsim.options.base import Options
from irsim.options.colors import Color
from irsim.options.regions import OUTLINE_ALIASES, Corners, Points, Rectangle, rectangle_corners
from irsim.options.units import Fraction, Meters, Number, Seconds
from irsim.options.vectors import Point

__all__ = ["OUTLINES", "Disc", "Zone"]

OUTLINES = ("line", "polygon", "rectangle", "circle")
"""Keys that say where a zone is; each zone has exactly one of them."""


class Disc(Options):
    """A disc of the world."""

    center: Point
    """Centre: [x, y]."""
    radius: Annotated[Meters, Field(gt=0)]
    """Radius of the disc."""


class Zone(Options):
    """A line that objects cross, or an area that they enter. It is neither solid nor seen by sensors.

    Give exactly one of `line`, `polygon`, `rectangle` and `circle`, in world coordinates. An area may say what its
    ground does to wheels: `slip`, `grip`, `surface`. Each wheel feels the ground at its own place at the start of a
    step: both wheels of `diff`, `diff_dynamic` and `skid_steer`, the front wheel of `tricycle`, both axles of
    `single_track`, of which the rear one drives, the middle of the rear axle of `acker`; of `omni` and `omni_angular`
    the whole motion is scaled at the reference point. Where areas overlap, the last one in the list counts. Behaviors
    and planners do not know of it.
    """

    also_called: ClassVar[dict[str, str]] = {
        **OUTLINE_ALIASES,
        "gate": "line",
        "segment": "line",
        "points": "line",
        "region": "rectangle",
        "disc": "circle",
        "slippage": "slip",
        "mu": "grip",
        "ground": "surface",
    }
    schema_extra: ClassVar[dict[str, Any]] = {
        "oneOf": [{"required": [key], "properties": {key: {"not": {"type": "null"}}}} for key in OUTLINES],
        "examples": [
            {"name": "door", "line": [[5, 4], [5, 6]]},
            {"name": "kitchen", "rectangle": [6, 1, 9, 4]},
            {"name": "stairs", "polygon": [[1, 7], [3, 7], [2, 9]]},
            {"name": "dock", "circle": {"center": [8, 8], "radius": 0.5}},
            {"name": "wet", "rectangle": [2, 0, 5, 3], "slip": 0.2, "slip_std": 0.05, "grip": 0.4},
            {"name": "yard", "rectangle": [5, 0, 9, 3], "surface": "gravel"},
        ],
    }

    name: Annotated[str, Field(strict=True, min_length=1)]
    """Unique name of the zone, which events and metrics use."""
    line: Annotated[Points, Field(min_length=2, max_length=2)] | None = None
    """A line from one point to another: [[x, y], [x, y]]. An object crosses it when its centre does; left and right
    are as seen from the first point towards the second."""
    polygon: Corners | None = None
    """An area: its corners in order, [[x, y], [x, y], ...]. An object is inside as long as its body touches the
    area."""
    rectangle: Rectangle | None = None
    """An area: [x_min, y_min, x_max, y_max]."""
    circle: Disc | None = None
    """An area: a disc with `center` and `radius`."""
    color: Color | None = None
    """Colour of the zone in pictures; null is one colour for all zones. `world.plot.show_zones` draws them."""

    slip: Fraction = 0.0
    """Share of the way of a wheel that the body does not move: at 0.2 a wheel that turns by 1 m drives 0.8 m. A robot
    with one wheel on it turns."""
    slip_std: Fraction = 0.0
    """Standard deviation of the slip of each wheel, which wanders around `slip` and stays between 0 and 1."""
    slip_time: Annotated[Seconds, Field(ge=0)] = 1.0
    """Time in which a deviation falls to 1 / e; 0 draws a new one in each step."""
    grip: Annotated[Number, Field(gt=0, le=2)] = 1.0
    """Factor on the friction of drives with forces, `single_track` and `diff_dynamic`: 0.1 is ice."""
    surface: Surface | None = None
    """The ground under `skid_steer`: it sets the ICRs and the traction of each side that is on it."""

    @property
    def has_ground(self) -> bool:
        """Whether its ground changes what wheels do."""
        return bool(self.slip or self.slip_std or self.grip != 1.0 or self.surface)

    @property
    def title(self) -> str:
        """Its name as pictures show it, with what its ground does."""
        told = [f"slip {self.slip:.0%}"] if self.slip or self.slip_std else []
        told += [f"grip {self.grip:g}"] if self.grip != 1.0 else []
        told += [self.surface] if self.surface else []
        return f"{self.name}: {', '.join(told)}" if told else self.name

    @property
    def is_line(self) -> bool:
        """Whether the zone is a line, not an area."""
        return self.line is not None

    @property
    def points(self) -> list[list[float]]:
        """The two ends of a line, or the corners of a polygon or rectangle [m]; empty for a disc."""
        if self.rectangle is not None:
            return rectangle_corners(self.rectangle)
        return self.line or self.polygon or []

    def covers(self, x: float, y: float) -> bool:
        """Whether a point lies in the area; never in a line."""
        if self.circle is not None:
            return math.dist((x, y), self.circle.center) <= self.circle.radius
        inside, corners = False, [] if self.is_line else self.points
        for (ax, ay), (bx, by) in zip(corners, [*corners[1:], *corners[:1]], strict=True):
            if (ay > y) != (by > y) and x < ax + (y - ay) / (by - ay) * (bx - ax):
                inside = not inside
        return inside

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x_min, y_min, x_max, y_max of the zone [m]."""
        if self.circle is not None:
            (x, y), r = self.circle.center, self.circle.radius
            return x - r, y - r, x + r, y + r
        xs, ys = [point[0] for point in self.points], [point[1] for point in self.points]
        return min(xs), min(ys), max(xs), max(ys)
