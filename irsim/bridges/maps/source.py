"""Results of readers of files: the triangles of a scene, or a map that is ready; and the kinds of files."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import Bools, Grid, Triangles
from irsim.common.arrays import Floats
from irsim.common.lazy import module_names
from irsim.common.text import clean
from irsim.components.maps._site import HALF
from irsim.options.base import Options
from irsim.options.units import Degrees, Fraction, Meters

__all__ = [
    "NOT_FLAT",
    "ImportLimits",
    "ImportOptions",
    "Kind",
    "Occupancy",
    "Outlined",
    "Outlines",
    "SceneTriangles",
    "find_kind",
    "kinds",
    "known_free",
    "unusable",
]


class ImportOptions(Options):
    """How a map is made from a scene."""

    resolution: Annotated[Meters, Field(gt=0, le=100)] | None = None
    """Side of a cell. Default: 0.05 m, more where the map would be too large, less where walls are thin."""
    headroom: Annotated[Meters, Field(gt=0, le=100)] = 1.5
    """Free height above a floor that the robot needs; what hangs lower is an obstacle."""
    slope: Annotated[Degrees, Field(ge=0, lt=90)] = 45.0
    """Steepest surface that is a floor."""
    climb: Annotated[Meters, Field(ge=0, le=10)] = 0.2
    """Highest step that the robot climbs; what is lower is part of the floor."""
    root: str | None = None
    """Folder with models and meshes that a world of Gazebo names, as in ``model://table``; others are looked for where
    ``GZ_SIM_RESOURCE_PATH`` and ``GAZEBO_MODEL_PATH`` say. A USD stage or a ``.gltf`` may refer to its files, too."""
    radius: Annotated[Meters, Field(ge=0, le=10)] = 0.0
    """Distance from obstacles within which cells become occupied. irsim keeps a robot's own shape clear of obstacles;
    only planning for points needs it."""
    up: Literal["auto", "y", "z", "-y"] = "auto"
    """Axis of a mesh, a stage or of splats that points up; ``-y``: y points down. ``auto`` is y for glTF and OBJ, z for
    PLY and STL, and what a stage of USD says."""
    rotate: tuple[Degrees, Degrees, Degrees] | None = None
    """Roll, pitch and yaw by which a mesh, a stage or splats are turned before ``up`` counts: about the x, then the y,
    then the z axis of the file. Default: splats are turned upright, by up to 45°; all else stays as it is."""
    level: Annotated[int, Field(ge=0)] | None = None
    """Number of the level, the lowest is 0. Default: the largest one that is not a roof of another."""
    height: Meters | None = None
    """Height of a floor along the upward axis: the nearest level is taken."""
    ground: Meters | None = None
    """Height of a flat ground along the upward axis that a mesh or a stage does not have, and that the robot is on.
    Default: none."""
    seed_point: tuple[Meters, Meters] | None = None
    """x, y of a place that is free: what is connected to it is free in the map. Default: the largest connected part."""
    unknown: Literal["free", "occupied", "unknown"] | None = None
    """How the scenario takes unknown cells: ``unknown`` ones let beams and bodies pass, while planners and random
    places keep out. Default: unknown for maps of ROS, else occupied."""
    meters_per_unit: Annotated[Meters, Field(gt=0, le=1e6)] | None = None
    """Length of a unit of a mesh, a stage or a scene of splats, such as 0.001 for millimeters. Default: what a stage of
    USD says, else 1."""
    opacity: Annotated[Fraction, Field(gt=0)] = 0.05
    """Splats with less opacity are left out."""
    bounds: tuple[Meters, Meters, Meters, Meters] | None = None
    """Left, lower, right and upper bound of the part that becomes the map. Default: all, without far splats."""
    lanes: Literal["drive", "walk", "all"] = "drive"
    """Lanes of roads that are free: those for vehicles, those for pedestrians, or both."""
    layers: Annotated[tuple[str, ...], Field(min_length=1, max_length=1000)] | None = None
    """Names of the layers of a floor plan that count, such as the layers of walls. Default: all that are seen."""


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


_HEAD = 4096
"""Bytes of a file by which its kind is known."""
_LICENCE = 64 * 1024
"""The same where it begins with a comment of XML."""
_BEFORE_ROOT = re.compile(
    r"\A\ufeff?(?:\s|<!--(?:(?!-->).)*-->|<\?(?:(?!\?>).)*\?>|<!DOCTYPE[^\[>]*(?:\[(?:(?!\]\s*>).)*\]\s*)?>)*"
    r"<(?:[\w.-]+:)?([\w.-]+)",
    re.DOTALL,
)
"""Everything up to the name of the root element of a file of XML."""


def known_free(values: Floats) -> Bools:
    """Which cells are known to be free."""
    return (values >= 0) & (values <= HALF)


@dataclass
class SceneTriangles:
    """Triangles of a scene.

    Attributes:
        frame: Convention of the file's axes, see :mod:`irsim.bridges.frames`.
        solid: Surfaces of solid things, counterclockwise seen from outside; empty if the file has floors instead.
        floors: Places where one can walk or drive by what the file says.
        barred: Places where one cannot walk or drive by what the file says.
        meters_per_unit: Length of a unit of the file [m].
        headroom, climb: Height and step of the robot that the floors were made for [m]; None if the file does not say.
        radius: Distance from walls that the floors keep already [m].
        notes: Remarks for the user.
        turn: (3, 3) rotation in the frame of the file that has made it upright; None if there was none.
    """

    frame: str
    solid: Triangles = field(default_factory=lambda: np.zeros((0, 3, 3)))
    floors: Triangles = field(default_factory=lambda: np.zeros((0, 3, 3)))
    barred: Triangles = field(default_factory=lambda: np.zeros((0, 3, 3)))
    meters_per_unit: float = 1.0
    headroom: float | None = None
    climb: float | None = None
    radius: float = 0.0
    notes: list[str] = field(default_factory=list)
    turn: Floats | None = None


@dataclass
class Occupancy:
    """A map that is ready to be written.

    Attributes:
        values: (nx, ny) occupancies 0 to 100, -1 where unknown.
        grid: The cells.
        frame: Convention of the axes of the world that it was made from.
        height: Height of the floor along the upward axis [m].
        meters_per_unit: Length of a unit of that world [m].
        level: Number of the level, the lowest is 0.
        levels: For each level: height [m], area of its largest connected part [m²], whether it is a roof.
        regions: Areas of the connected parts of the level [m²], the largest first.
        kept: Number of the part that is free in the map; None if all are.
        radius: Distance from walls that free cells keep already [m].
        headroom, climb: Height and step of the robot that the file was made for [m]; None if the options decide.
        notes: Remarks for the user.
        parts: Other files that it was read from.
        things: Outlines that it was made from; None if it was made from something else.
        turn: (3, 3) rotation in the frame of the file that has made it upright; None if there was none.
    """

    values: Floats
    grid: Grid
    frame: str
    height: float = 0.0
    meters_per_unit: float = 1.0
    level: int = 0
    levels: list[tuple[float, float, bool]] = field(default_factory=list)
    regions: list[float] = field(default_factory=list)
    kept: int | None = None
    radius: float = 0.0
    headroom: float | None = None
    climb: float | None = None
    notes: list[str] = field(default_factory=list)
    parts: list[Path] = field(default_factory=list)
    things: list[Outlined] | None = None
    turn: Floats | None = None


@dataclass(frozen=True)
class Outlined:
    """Something that stands in the way.

    Attributes:
        name: Its name in the file; empty if it has no name.
        region: The area that it occupies, a polygon or polygons of shapely [m], z up.
        circle: Center and radius if it is a disk [m].
    """

    name: str
    region: Any
    circle: tuple[float, float, float] | None = None


@dataclass
class Outlines:
    """Outlines of all that stands in the way; everything else is free.

    Attributes:
        things: The things that stand in the way.
        frame: Convention of the axes of the file's world, see :mod:`irsim.bridges.frames`.
        solid: The area that the things cover together, if the reader has united them.
        free: The area that is free by what the file says, such as roads; None for everything between the things.
        ground: Left, lower, right and upper bound of a ground that the map covers, too [m]; None for a margin around
            the things.
        meters_per_unit: Length of a unit of the file [m].
        height: Height of the floor along the upward axis [m].
        headroom, climb: Height and step of the robot that the file was made for [m]; None if the options decide.
        notes: Remarks for the user.
        parts: Other files that it was read from.
    """

    things: list[Outlined]
    frame: str = "irsim"
    solid: Any = None
    free: Any = None
    ground: tuple[float, float, float, float] | None = None
    meters_per_unit: float = 1.0
    height: float = 0.0
    headroom: float | None = None
    climb: float | None = None
    notes: list[str] = field(default_factory=list)
    parts: list[Path] = field(default_factory=list)


NOT_FLAT = (
    "headroom",
    "slope",
    "ground",
    "climb",
    "up",
    "rotate",
    "level",
    "height",
    "meters_per_unit",
    "opacity",
    "lanes",
    "root",
)
"""Options of surfaces and scales, which say nothing about flat files in meters, see :attr:`Kind.unused`."""


@dataclass(frozen=True)
class Kind:
    """A kind of files that maps are made from; module ``irsim.bridges.maps.kinds.x`` has it as ``KIND``.

    Attributes:
        name: Its name.
        title: Such a file in messages, as in ``a mesh``.
        suffixes: How names of such files end.
        read: Reads a file; its errors are :class:`~irsim.bridges.base.BridgeError`.
        accepts: Whether a file may be of this kind, by its first bytes. Files of XML are known by their root element.
        unknown: Whether unknown cells count as free, occupied or unknown unless the caller decides.
        extra: Extra of pyproject.toml whose libraries it needs.
        libraries: Their modules.
        unused: Names of options that say nothing about such files.
        roots: Names of the root elements of such files, if they are files of XML.
        by_name: Whether only the names of such files say what they are.
        layered: Whether such files have layers that one can choose.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    read: Callable[[Path, ImportOptions, ImportLimits], SceneTriangles | Occupancy | Outlines]
    accepts: Callable[[bytes], bool] = lambda head: False
    unknown: str = "occupied"
    extra: str = "mesh"
    libraries: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    roots: tuple[str, ...] = ()
    by_name: bool = False
    layered: bool = False


@cache
def kinds() -> tuple[Kind, ...]:
    """All kinds, sorted by name."""
    package = "irsim.bridges.maps.kinds"
    return tuple(import_module(f"{package}.{name}").KIND for name in module_names(package))


def find_kind(path: Path) -> Kind:
    """The kind of a file, by its suffix and its first bytes.

    Raises:
        BridgeError: The file does not exist, or is of no known kind.
    """
    if path.exists() and not path.is_file():
        raise unusable(path.resolve(), "it is a folder or a device, no file", "give a file")
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD)
            if b"<!--" in head:
                head += file.read(_LICENCE)
    except OSError as error:
        raise unusable(path, f"it cannot be read: {error.strerror or error}", "check the name of the file") from None
    suffix = path.suffix.lower()
    root = xml_root(head)
    if root is not None:
        return _xml_kind(path, root)
    named = [kind for kind in kinds() if suffix in kind.suffixes]
    fitting = [kind for kind in named or kinds() if kind.accepts(head) and (named or not kind.by_name)]
    if fitting:
        return fitting[0]
    if named:
        raise unusable(path, f"it is {'empty' if not head else f'not {named[0].title}, as its name says'}")
    known = ", ".join(sorted({suffix for kind in kinds() for suffix in kind.suffixes}))
    raise unusable(path, "no map is made from files of this kind", f"give a file with one of the suffixes {known}")


def xml_root(head: bytes) -> str | None:
    """Name of the root element of a text of XML, without its namespace; None if the text is none of XML.

    Args:
        head: The first bytes of the text.
    """
    wide = head[:2] in (b"\xff\xfe", b"\xfe\xff")
    match = _BEFORE_ROOT.match(head.decode("utf-16" if wide else "utf-8", "ignore"))
    return match[1] if match else None


def _xml_kind(path: Path, root: str) -> Kind:
    """The kind of a file of XML, by its root element, whatever its name."""
    fitting = [kind for kind in kinds() if root in kind.roots]
    if fitting:
        return fitting[0]
    known = ", ".join(f"<{name}>" for name in sorted({name for kind in kinds() for name in kind.roots}))
    what = f"it is an XML file of '{clean(root, 50)}', from which no map is made"
    raise unusable(path, what, f"give one whose root element is one of {known}")


def unusable(path: Path, why: str, fix: str | None = None) -> BridgeError:
    """The error that a file cannot be used."""
    advice = "write the file again with the program that made it" if fix is None else fix
    return BridgeError("bridge-file", f"'{clean(path.name, 200)}' cannot be imported: {why}", advice)
