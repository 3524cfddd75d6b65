"""The files of an imported map: scenario, picture, sidecar, and a map for the ROS map server."""

from __future__ import annotations

import io
import json
import math
import os
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image

from irsim.bridges.maps.grid import Bools
from irsim.bridges.maps.occupancy import within
from irsim.bridges.maps.regions import masked_regions
from irsim.bridges.maps.sidecar import MapSidecar, sidecar_path
from irsim.bridges.maps.source import Occupancy, known_free
from irsim.common.arrays import Floats
from irsim.common.files import TargetError, check_new, create_bytes, is_stream, make_folder_of, replace_bytes
from irsim.common.text import decimal
from irsim.components.maps._rosmap import RosMeta, pixels_of
from irsim.scenario.yaml.modeline import with_modeline

__all__ = ["Trip", "files_of", "picture_bytes", "suggest_trip", "write_all_or_none"]

_CLEARANCES = (0.5, 0.4, 0.3, 0.25, 0.2, 0.15, 0.1, 0.05)
"""Distances from obstacles that are tried [m], the widest first."""
_SHARE = 0.7
"""Share of the diagonal of all free cells that the places with that clearance must reach over."""
_DIGITS = 9
"""Digits of lengths behind the point: others come from rounding."""
_MAX_REACH = 64
"""Cells over which clearances are measured."""


@dataclass(frozen=True)
class Trip:
    """A start and a goal between which a point keeps a distance from everything that is not free.

    Attributes:
        start, goal: x, y, heading [m, rad].
        clearance: That distance [m].
    """

    start: tuple[float, float, float]
    goal: tuple[float, float, float]
    clearance: float


def suggest_trip(occupancy: Occupancy, values: Floats) -> Trip | None:
    """Two places far apart in a map, both connected with as much room as most of the map has; None if it has no room.

    Args:
        occupancy: The map.
        values: (nx, ny) its occupancies, -1 where unknown: the way goes over cells that are known to be free.
    """
    free = known_free(values)
    side = occupancy.grid.resolution
    if not free.any():
        return None
    needed = _SHARE * _diagonal(masked_regions(free)[0] == 0)
    for clearance in (*_CLEARANCES, side / 2):
        roomy = free & ~within(~free, min(clearance / side, _MAX_REACH) + 0.5)
        if roomy.any():
            places = masked_regions(roomy)[0] == 0
            if _diagonal(places) >= needed or clearance <= side:
                return _trip(occupancy, places, clearance)
    return None


def _diagonal(places: Bools) -> float:
    """Diagonal of the rectangle around places [cells]."""
    i, j = np.nonzero(places)
    return math.hypot(float(i.max() - i.min()), float(j.max() - j.min()))


def _trip(occupancy: Occupancy, places: Bools, clearance: float) -> Trip:
    columns = np.flatnonzero(places)
    points = occupancy.grid.centers(columns)
    first = _farthest(points, points.mean(axis=0))
    second = _farthest(points, first)
    start, goal = sorted([first.tolist(), second.tolist()])
    heading = round(math.atan2(goal[1] - start[1], goal[0] - start[0]), 3)
    a, b = ((round(x, 3), round(y, 3), heading) for x, y in (start, goal))
    return Trip(a, b, clearance)


def _farthest(points: Floats, place: Floats) -> Floats:
    far: Floats = points[np.argmax(((points - place) ** 2).sum(axis=1))]
    return far


_ROBOT_RADIUS = 0.2
_ROOM = 0.8
"""Share of the clearance of a trip that the robot's radius may have."""
_SPEED = 0.5
"""Speed by which the time limit is set [m/s], half of the robot's own."""


def files_of(
    occupancy: Occupancy,
    values: Floats,
    filled: Floats,
    target: Path,
    sidecar: MapSidecar,
    about: str,
    trip: Trip | None,
    ros_map: Path | None,
    entries: list[str] | None = None,
) -> list[tuple[Path, bytes]]:
    """Paths and contents of all files of an imported map.

    Args:
        occupancy: Values and place of the map.
        values: (nx, ny) occupancies, -1 where unknown.
        filled: (nx, ny) the same with unknown cells filled in; cells that stay unknown need a map of ROS, whose picture
            tells them apart.
        target: The scenario.
        sidecar: Content of the sidecar.
        about: A sentence about the source.
        trip: Start and goal of a robot; None for no robot.
        ros_map: YAML file of a map for the ROS map server; None for no such file.
        entries: Obstacles as lines of YAML, which take the place of the picture; None for the picture.
    """
    picture, grid = target.with_suffix(".png"), occupancy.grid
    described = target.with_suffix(".map.yaml") if entries is None and (filled < 0).any() else None
    width, height = grid.nx * grid.resolution, grid.ny * grid.resolution
    lines = [f"# {about}; {sidecar_path(target).name} says where it is in the world of that file.", "world:"]
    if trip is not None:
        lines += [f"  time_limit: {_time_limit(trip, width + height)}"]
    lines += [
        f"  width: {decimal(width, _DIGITS)}",
        f"  height: {decimal(height, _DIGITS)}",
        f"  offset: [{decimal(grid.x, _DIGITS)}, {decimal(grid.y, _DIGITS)}]",
    ]
    if described is not None:
        lines.append(f"  obstacle_map: {{name: ros, path: {json.dumps(described.name)}, unknown: unknown}}")
    elif entries is None:
        lines.append(f"  obstacle_map: {{name: image, path: {json.dumps(picture.name)}}}")
    if trip is not None:
        lines += _robot(trip)
    if entries:
        lines += ["obstacle:", *entries]
    place = (round(grid.x, _DIGITS), round(grid.y, _DIGITS), 0.0)
    meta = RosMeta(picture.name, round(grid.resolution, _DIGITS), place)
    grey = np.round(255 * (1 - np.clip(filled[:, ::-1].T, 0, 100) / 100)).astype(np.uint8)
    pixels = grey if described is None else pixels_of(values, meta)
    contents = [
        (target, with_modeline("\n".join(lines) + "\n", target).encode()),
        *([(picture, picture_bytes(pixels, "PNG"))] if entries is None else []),
        (sidecar_path(target), sidecar.as_json().encode()),
    ]
    if described is not None:
        contents.append((described, meta.as_yaml().encode()))
    if ros_map is not None:
        image = ros_map.with_suffix(".pgm")
        meta = replace(meta, image=image.name)
        contents += [(ros_map, meta.as_yaml().encode()), (image, picture_bytes(pixels_of(values, meta), "PPM"))]
    return contents


def _robot(trip: Trip) -> list[str]:
    radius = round(min(_ROBOT_RADIUS, _ROOM * trip.clearance), 3)
    pose, goal = ([round(x, 3) for x in place] for place in (trip.start, trip.goal))
    return [
        "robot:",
        "  - kinematics: {name: diff}",
        f"    shape: {{name: circle, radius: {radius}}}",
        f"    state: {pose}",
        f"    goal: {goal}",
        "    behavior: {name: follow}",
        "    plot: {show_goal: true, show_trajectory: true}",
    ]


def _time_limit(trip: Trip, extent: float) -> int:
    """Time for a way around the whole map [s]."""
    direct = math.dist(trip.start[:2], trip.goal[:2])
    return math.ceil((30 + (2 * direct + extent) / _SPEED) / 10) * 10


def picture_bytes(pixels: np.ndarray, kind: str) -> bytes:
    """A picture as a file: ``PNG``, or ``PPM``, which is ``.pgm`` for grey ones."""
    target = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(target, format=kind, optimize=kind == "PNG")
    return target.getvalue()


def write_all_or_none(contents: list[tuple[Path, bytes]], *, overwrite: bool) -> None:
    """Write files, in folders that are made if need be; if one cannot be written, the new ones are deleted.

    Raises:
        TargetError: Two are the same file, or one exists and ``overwrite`` is not set.
    """
    if len({path.absolute() for path, _ in contents}) < len(contents):
        raise TargetError("bad-argument", "two of the files would have the same name", "give the map another name")
    for path, _ in contents:
        check_new(path, overwrite=overwrite)
    for path, _ in contents:
        make_folder_of(path)
    made: list[Path] = []
    try:
        for path, content in contents:
            new = not os.path.lexists(path)
            if overwrite or is_stream(path):
                replace_bytes(path, content, mode=None)
            else:
                create_bytes(path, content, mode=0o666)
            if new:
                made.append(path)
    except BaseException as error:
        for path in made:
            with suppress(OSError):
                path.unlink()
        if isinstance(error, FileExistsError):
            check_new(path, overwrite=False)
        raise
