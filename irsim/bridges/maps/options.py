"""What an import of a map can be asked for, and how much it may cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from irsim.options.base import Options
from irsim.options.units import Degrees, Fraction, Meters

__all__ = ["ImportLimits", "ImportOptions"]


class ImportOptions(Options):
    """How a map is made from a scene."""

    resolution: Annotated[Meters, Field(gt=0, le=100)] = 0.05
    """Side of a cell."""
    headroom: Annotated[Meters, Field(gt=0, le=100)] = 1.5
    """Free height above a floor that the robot needs; what hangs lower is an obstacle."""
    slope: Annotated[Degrees, Field(ge=0, lt=90)] = 45.0
    """Steepest surface that is a floor."""
    climb: Annotated[Meters, Field(ge=0, le=10)] = 0.2
    """Highest step that the robot climbs; what is lower is part of the floor."""
    radius: Annotated[Meters, Field(ge=0, le=10)] = 0.0
    """Distance from obstacles within which cells become occupied. irsim keeps a robot's own shape clear of obstacles;
    only planning for points needs it."""
    up: Literal["auto", "y", "z", "-y"] = "auto"
    """Axis of a mesh, a stage or of splats that points up; ``-y``: y points down. ``auto`` is y for glTF and OBJ, z for
    PLY and STL, and what a stage of USD says."""
    level: Annotated[int, Field(ge=0)] | None = None
    """Number of the level, the lowest is 0. Default: the largest one that is no roof of another."""
    height: Meters | None = None
    """Height of a floor along the upward axis: the nearest level is taken."""
    seed_point: tuple[Meters, Meters] | None = None
    """x, y of a place that is free: what is connected to it is free in the map. Default: the largest connected part."""
    unknown: Literal["free", "occupied"] | None = None
    """Whether unknown cells count as free or occupied in the scenario. Default: free for maps of ROS, else occupied."""
    meters_per_unit: Annotated[Meters, Field(gt=0, le=1e6)] | None = None
    """Length of a unit of a mesh, a stage or a scene of splats, such as 0.001 for millimeters. Default: what a stage of
    USD says, else 1."""
    opacity: Annotated[Fraction, Field(gt=0)] = 0.05
    """Splats with less opacity are left out."""
    bounds: tuple[Meters, Meters, Meters, Meters] | None = None
    """Left, lower, right and upper bound of the part that becomes the map. Default: all, without far splats."""
    lanes: Literal["drive", "walk", "all"] = "drive"
    """Lanes of roads that are free: those for vehicles, those for pedestrians, or both."""


@dataclass(frozen=True)
class ImportLimits:
    """Upper bounds of an import; a server passes tighter ones.

    Attributes:
        root: Folder that must contain the file and what is written; None allows any place.
        bytes: Size of the file.
        cells: Cells of the map.
        triangles: Triangles of the scene.
        seconds: Time for reading a file in a process of its own, which only USD stages need [s].
    """

    root: str | None = None
    bytes: int = 2 * 1024**3
    cells: int = 8_000_000
    triangles: int = 20_000_000
    seconds: float = 300.0
