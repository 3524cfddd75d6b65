"""``irsim bridge import-bag``: a bag becomes a scenario, whose map counts beams that ended in a cell or crossed it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from irsim.bridges.base import BridgeError
from irsim.bridges.maps.grid import fitting_side, side_notes
from irsim.bridges.maps.writing import picture_bytes, write_all_or_none
from irsim.bridges.ros.bags.reading import Recorded, read_bag
from irsim.bridges.ros.incoming import Scan
from irsim.bridges.ros.real import composed
from irsim.common.arguments import check_positive
from irsim.common.arrays import Floats
from irsim.components.maps._rosmap import RosMeta, pixels_of
from irsim.components.maps._site import FREE, OCCUPIED, UNKNOWN
from irsim.scenario.limits import DEFAULT_LIMITS
from irsim.scenario.yaml.modeline import with_modeline

__all__ = ["BagMap", "BagOptions", "ImportedBag", "import_bag", "map_of_scans"]

MAX_CELLS = 25_000_000
_MAX_SAMPLES = 2_000_000
"""Points of beams that are handled at once."""
_NEAR_SHARE = 0.99
"""Share of hits that are nearer than where a beam without one is known to be free."""
_SAME_RANGE = 1e-6
"""Relative difference from the greatest range within which a beam has hit nothing."""


@dataclass(frozen=True)
class BagMap:
    """A grid.

    Attributes:
        levels: (nx, ny) 100 where beams ended, 0 where they went through, -1 where none came.
        resolution: Side of a cell [m].
        origin: Lower left corner [m].
    """

    levels: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float]


def map_of_scans(
    poses: Floats,
    scans: Sequence[Scan],
    path: Floats,
    resolution: float | None,
    radius: float,
    margin: float,
    range_max: float | None = None,
) -> BagMap:
    """Count the beams of scans.

    A beam that hit nothing clears cells as far as ``range_max``, but never beyond the cells that hits and the path
    need. A cell is solid if at least half as many beams ended
    in it as went through, since beams also graze the edge of what is solid.

    Args:
        poses: (S, 3) poses of the lidar at the scans.
        scans: S scans.
        path: (T, 2) where the robot was: it was free there.
        resolution: Side of a cell [m]; None for the smallest usual one with which the map is small enough.
        radius: Radius of the robot [m].
        margin: Border around the path and the hits [m].
        range_max: How far beams count [m]; None: for hits all of it, for beams that hit nothing 99 % of the hits.

    Raises:
        BridgeError: The map would have too many cells.
    """
    if range_max is None:
        matches = np.concatenate([scan.ranges[_is_hit(scan)] for scan in scans])
        range_max = float(np.quantile(matches, _NEAR_SHARE)) if len(matches) else 0.0
        reach = math.inf
    else:
        reach = range_max
    ends = [_ends(pose, scan, reach, range_max) for pose, scan in zip(poses, scans, strict=True)]
    corners = np.concatenate([path, *(points[hit] for points, hit in ends)])
    box = corners.min(axis=0) - margin, corners.max(axis=0) + margin
    resolution = fitting_side(resolution, *box, MAX_CELLS)
    low = np.floor(box[0] / resolution) * resolution
    sides = np.ceil((box[1] - low) / resolution)
    if not sides.prod() <= MAX_CELLS:
        what = f"the map would have {sides[0]:.0f} x {sides[1]:.0f} cells"
        raise BridgeError(
            "bridge-file", what, f"give a larger cell: --resolution {fitting_side(None, *box, MAX_CELLS):g}"
        )
    counts = sides.astype(np.int64)
    hits, passes = np.zeros(counts, dtype=np.int64), np.zeros(counts, dtype=np.int64)
    for pose, (points, hit) in zip(poses, ends, strict=True):
        _count(hits, points[hit], low, resolution)
        for part in _through(pose[:2], points, resolution):
            _count(passes, part, low, resolution)
    levels = np.full(counts, UNKNOWN, dtype=np.int8)
    levels[passes > 0] = FREE
    levels[(hits > 0) & (2 * hits >= passes)] = OCCUPIED
    _clear(levels, path, low, resolution, radius)
    return BagMap(levels, resolution, (float(low[0]), float(low[1])))


def _is_hit(scan: Scan) -> NDArray[np.bool_]:
    """(N,) whether beams hit something: drivers write the greatest range, or more, where nothing came back."""
    hit: NDArray[np.bool_] = (scan.ranges >= scan.low) & (scan.ranges < scan.high * (1 - _SAME_RANGE))
    return hit


def _ends(pose: Floats, scan: Scan, reach: float, cleared: float) -> tuple[Floats, NDArray[np.bool_]]:
    """(K, 2) ends of the usable beams, and (K,) whether they hit something.

    Args:
        pose: Pose of the lidar.
        scan: The scan.
        reach: How far hits count [m]; a farther one is as nothing.
        cleared: How far beams that hit nothing are known to be free [m].
    """
    with np.errstate(invalid="ignore"):  # signalling NaN
        ranges = scan.ranges.astype(np.float64)
    angles = pose[2] + scan.angle_min + scan.increment * np.arange(len(ranges))
    hit = _is_hit(scan) & (ranges <= reach)
    missed = ~hit & ~np.isnan(ranges) & (ranges >= scan.low)
    used = hit | missed
    lengths = np.where(hit, ranges, min(cleared, scan.high))[used]
    points = pose[:2] + lengths[:, None] * np.column_stack([np.cos(angles[used]), np.sin(angles[used])])
    return points, hit[used]


def _through(start: Floats, ends: Floats, resolution: float) -> list[Floats]:
    """Points along beams, closer together than cells, without the last cell of each."""
    lengths = np.hypot(*(ends - start).T)
    steps = np.maximum(0, np.floor(lengths / (0.7 * resolution)).astype(np.int64) - 1)
    parts = []
    size = max(1, _MAX_SAMPLES // max(1, int(steps.max(initial=1))))
    for first in range(0, len(ends), size):
        some, count = ends[first : first + size], steps[first : first + size]
        beam = np.repeat(np.arange(len(some)), count)
        place = np.arange(len(beam)) - np.repeat(np.cumsum(count) - count, count)
        share = place / np.maximum(1.0, lengths[first : first + size] / (0.7 * resolution))[beam]
        parts.append(start + share[:, None] * (some[beam] - start))
    return parts


def _count(counts: NDArray[np.int64], points: Floats, low: Floats, resolution: float) -> None:
    """Add one to each cell once, however many points of a scan it has."""
    cells = np.floor((points - low) / resolution).astype(np.int64)
    cells = cells[((cells >= 0) & (cells < counts.shape)).all(axis=1)]
    counts.reshape(-1)[np.unique(np.ravel_multi_index(tuple(cells.T), counts.shape))] += 1


def _clear(levels: NDArray[np.int8], path: Floats, low: Floats, resolution: float, radius: float) -> None:
    """Where the robot was, it was free."""
    reach = math.ceil(radius / resolution) + 1
    steps = np.arange(-reach, reach + 1)
    around = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)
    around = around[np.hypot(*around.T) * resolution <= radius + resolution]
    own = np.unique(np.floor((path - low) / resolution).astype(np.int64), axis=0)
    for shift in around:
        cells = own + shift
        cells = cells[((cells >= 0) & (cells < levels.shape)).all(axis=1)]
        levels[cells[:, 0], cells[:, 1]] = FREE


_MAX_MAPPED = 3000
"""Scans of which the map is made; of more, some at equal distances."""
_MAX_STEPS = 10_000_000
"""Steps that an imported run may take."""
_EVENTS_PER_ROW = 6
"""Events of YAML of one recorded pose."""


@dataclass(frozen=True)
class BagOptions:
    """How a bag is read.

    Attributes:
        odom, scan: Topics; None for the only ones.
        mount: x, y [m], yaw [rad] of the lidar on the robot; None for what the bag says.
        resolution: Side of a cell of the map [m]; None for the smallest usual one with which the map is small enough.
        radius: Radius of the robot [m].
        step_time: [s].
        start, end: Window of time [s], from the first pose.
        range_max: How far beams count [m]; None: see :func:`map_of_scans`.
    """

    odom: str | None = None
    scan: str | None = None
    mount: tuple[float, float, float] | None = None
    resolution: float | None = None
    radius: float = 0.2
    step_time: float = 0.1
    start: float = 0.0
    end: float = math.inf
    range_max: float | None = None


@dataclass(frozen=True)
class ImportedBag:
    """Result of an import.

    Attributes:
        file: The scenario.
        map: Its map; None without scans.
        poses: Number of replayed poses.
        scans: Number of scans of which the map was made.
        duration: [s].
        notes: Remarks for the user.
    """

    file: str
    map: str | None
    poses: int
    scans: int
    duration: float
    notes: list[str] = field(default_factory=list)


def import_bag(
    path: str | Path, out: str | Path, options: BagOptions | None = None, *, overwrite: bool = False
) -> ImportedBag:
    """Write a scenario with the map that the scans of a bag saw, and a robot that drives as its odometry says.

    Args:
        path: A ``.bag`` file of ROS 1, or a folder of rosbag2.
        out: The scenario; its map is the file ``.map.yaml`` and the picture beside it.
        options: How the bag is read.
        overwrite: Replace files that exist.

    Raises:
        BridgeError: The bag cannot be used. Nothing is written then.
        ArgumentError: An option is not a positive number.
        TargetError: A file exists.
        ExtraError: rosbags is missing.
    """
    options, path, out = options or BagOptions(), Path(path), Path(out)
    check_positive(**{name: getattr(options, name) for name in ("resolution", "radius", "step_time", "range_max")})
    result = read_bag(path, options.odom, options.scan)
    rows = _rows(result, options)
    times, poses = result.times[rows] - result.times[rows[0]], result.poses[rows]
    if len(times) * _EVENTS_PER_ROW > DEFAULT_LIMITS.events:
        raise BridgeError("bridge-file", f"{len(times)} poses are more than a scenario may hold", "--start and --end")
    if times[-1] > _MAX_STEPS * options.step_time:
        what = f"its poses span {times[-1]:.4g} s, which is more than {_MAX_STEPS:,} steps of {options.step_time:g} s"
        raise BridgeError("bridge-file", what, "choose a part with --start and --end, or longer steps with --step-time")
    notes = [f"{result.ignored} messages were not usable and left out"] if result.ignored else []
    mount = options.mount or result.mount
    if mount is None and result.scans:
        notes.append("the bag does not say where the lidar is on the robot; --mount X,Y,YAW says it, 0,0,0 is assumed")
    mount = mount or (0.0, 0.0, 0.0)
    chosen = _chosen_scans(result, result.times[rows])
    scans = [result.scans[index] for index in chosen]
    grid: BagMap | None = None
    if scans:
        at = np.array([composed(_pose_at(result, result.scan_times[index]), mount) for index in chosen])
        grid = map_of_scans(at, scans, poses[:, :2], options.resolution, options.radius, 1.0, options.range_max)
        notes += side_notes(options.resolution, grid.resolution)
    elif result.scan_topic is None:
        named = " of this robot, so there is no map; --scan names another robot's"
        notes.append(f"the bag has no scans{named if result.elsewhere else ', so there is no map'}")
    text = _text(result, grid, times, poses, scans[0] if scans else None, mount, path.name, out, options)
    contents = [(out, with_modeline(text, out).encode())]
    picture = out.with_suffix(".png")
    if grid is not None:
        meta = RosMeta(picture.name, grid.resolution, (*grid.origin, 0.0))
        contents += [
            (picture, picture_bytes(pixels_of(grid.levels, meta), "PNG")),
            (_described(out), meta.as_yaml().encode()),
        ]
    write_all_or_none(contents, overwrite=overwrite)
    shown = str(picture) if grid is not None else None
    return ImportedBag(str(out), shown, len(times), len(scans), float(times[-1]), notes)


def _rows(recorded: Recorded, options: BagOptions) -> list[int]:
    """Rows in the window, at least one step apart; the last one is among them."""
    inside = np.flatnonzero((recorded.times >= options.start) & (recorded.times <= options.end))
    if len(inside) < 2:
        what = f"the window of time has {len(inside)} poses; they last {recorded.times[-1]:.1f} s"
        raise BridgeError("bridge-file", what, "--start 0")
    kept = [int(inside[0])]
    for row in inside.tolist():
        if recorded.times[row] - recorded.times[kept[-1]] >= options.step_time * (1 - 1e-6):
            kept.append(row)
    return kept if len(kept) > 1 else [int(inside[0]), int(inside[-1])]


def _chosen_scans(recorded: Recorded, times: Floats) -> list[int]:
    inside = np.flatnonzero((recorded.scan_times >= times[0]) & (recorded.scan_times <= times[-1]))
    if len(inside) <= _MAX_MAPPED:
        return [int(index) for index in inside]
    return [int(index) for index in inside[np.linspace(0, len(inside) - 1, _MAX_MAPPED).astype(np.int64)]]


def _pose_at(recorded: Recorded, time: float) -> tuple[float, float, float]:
    """The pose at a time, between two recorded ones."""
    after = int(np.clip(np.searchsorted(recorded.times, time), 1, len(recorded.times) - 1))
    before = recorded.poses[after - 1]
    share = (time - recorded.times[after - 1]) / (recorded.times[after] - recorded.times[after - 1])
    step = recorded.poses[after] - before
    step[2] = math.remainder(step[2], 2 * math.pi)
    x, y, yaw = (before + float(np.clip(share, 0, 1)) * step).tolist()
    return x, y, yaw


def _text(
    recorded: Recorded, grid: BagMap | None, times: Floats, poses: Floats, scan: Scan | None,
    mount: tuple[float, float, float], name: str, out: Path, options: BagOptions,
) -> str:  # fmt: skip
    if grid is not None:
        extent = [f"  obstacle_map: {{name: ros, path: {json.dumps(_described(out).name)}, unknown: unknown}}"]
    else:
        low = np.floor(poses[:, :2].min(axis=0) - 1)
        size = np.ceil(poses[:, :2].max(axis=0) + 1) - low
        extent = [f"  width: {size[0]:.6g}", f"  height: {size[1]:.6g}", f"  offset: [{low[0]:.6g}, {low[1]:.6g}]"]
    lines = [
        f"# The robot of {json.dumps(name)} drives as {json.dumps(recorded.odom_topic)} says, for {times[-1]:.1f} s.",
        "# Written by `irsim bridge import-bag`.",
        "world:",
        *extent,
        f"  step_time: {options.step_time!r}",
        f"  time_limit: {times[-1] + 2 * options.step_time:.6g}",
        "  collision_mode: unobstructed  # the recording goes on, whatever the map says",
    ]
    rows = ", ".join(f"[{x:.4f}, {y:.4f}, {yaw:.4f}]" for x, y, yaw in poses.tolist())
    lines += [
        "robot:",
        "  - name: robot",
        "    kinematics: {name: omni_angular}",
        f"    waypoints: {_goals(times, poses, options.step_time)}",
        "    goal_threshold: 0.01",
        f"    shape: {{name: circle, radius: {options.radius!r}}}",
        "    behavior:",
        "      name: replay",
        f"      times: [{', '.join(f'{time:.4f}' for time in times.tolist())}]",
        f"      poses: [{rows}]",
    ]
    if scan is not None:
        lines.append(_lidar(scan, mount))
    return "\n".join(lines) + "\n"


def _goals(times: Floats, poses: Floats, step_time: float) -> list[list[float]]:
    """Where the robot is farthest from its end, then the end: one that comes back has not arrived at its start."""
    ends = np.arange(0.0, times[-1], step_time)
    places = np.column_stack([np.interp(ends, times, poses[:, axis]) for axis in (0, 1)])
    last = poses[-1, :2]
    farthest = places[np.hypot(*(places - last).T).argmax()]
    return [[round(value, 4) for value in (*place.tolist(), 0.0)] for place in (farthest, last)]


def _lidar(scan: Scan, mount: tuple[float, float, float]) -> str:
    """The lidar of the scans, which irsim has symmetric about its own x axis."""
    spread = abs(scan.increment) * (len(scan.ranges) - 1)
    middle = scan.angle_min + scan.increment * (len(scan.ranges) - 1) / 2
    offset = ", ".join(f"{value:.6g}" for value in (mount[0], mount[1], math.remainder(mount[2] + middle, 2 * math.pi)))
    return (
        f"    sensors:\n      - {{name: lidar2d, number: {len(scan.ranges)}, angle_range: {min(spread, 6.28318):.6g}, "
        f"range_min: {max(0.0, scan.low):.6g}, range_max: {scan.high:.6g}, offset: [{offset}]}}"
    )


def _described(out: Path) -> Path:
    """The file that describes the map: a picture alone cannot say what is unknown."""
    return out.with_suffix(".map.yaml")
