"""Checks sensors, fields of view and fog."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.angles import FULL_TURN
from irsim.diagnostics.diagnostic import Edit, Path
from irsim.options.units import is_span
from irsim.scenario.checks._context import Context
from irsim.scenario.checks.lidar_range import short_lidar
from irsim.scenario.checks.regions import unknown_zone
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.lookup import at
from irsim.scenario.resolve.body_size import has_fixed_shape, inner_disc, reach_of
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord

_MAX_FOG_CELLS = 16_000_000
"""Cells of the fog."""
_DEFAULT_CELL = 0.1
"""Cell size of the fog without a map [m]."""
_MIN_SPAN = 1e-3
"""Beams within a smaller angle point the same way [rad]."""


def check(context: Context) -> Iterator[Finding]:
    """Check the fog, then the sensors of each entry."""
    yield from _fog(context)
    for path, entry, records in context.entries():
        seen = set()
        for record in records:
            where = context.entry_path(record, "sensors")
            if where in seen:
                continue
            seen.add(where)
            for index, sensor in enumerate(record.sensors):
                yield from _sensor(context, (*where, index), sensor)
                blind = list(_blind_lidar(context, (*where, index), sensor, record))
                yield from blind or short_lidar(context, (*where, index), sensor, record)
        if not records:
            continue
        lidar = next((s for s in records[0].sensors if getattr(s, "is_lidar", False)), None)
        if entry.fov is None and entry.fov_radius is not None:
            reach = "the lidar's range_max is used" if lidar is not None else "there is no field of view"
            yield hint(
                "fov-radius-ignored",
                (*path, "fov_radius"),
                f"'fov_radius' has no effect without 'fov': {reach}",
                fix="add 'fov' (radians)",
            )
        if entry.fov is not None and entry.fov_radius is None and lidar is None:
            message = "without 'fov_radius' nothing is in view"
            yield hint("fov-without-radius", (*path, "fov"), message, fix="add 'fov_radius' (metres)")


def _sensor(context: Context, path: Any, sensor: Any) -> Iterator[Finding]:
    if getattr(sensor, "range_min", -math.inf) >= getattr(sensor, "range_max", math.inf):
        written = "range_min" if "range_min" in sensor.model_fields_set else "range_max"
        yield error(
            "range-order",
            (*path, written),
            f"range_min must be smaller than range_max, got {sensor.range_min:g} and {sensor.range_max:g}",
            given=getattr(sensor, written),
            fix="lower range_min or raise range_max",
        )
    if getattr(sensor, "is_lidar", False):
        written = at(context.document.data, (*path, "angle_range"))
        if not isinstance(written, (int, float)) or is_span(written):
            yield from _beams(path, sensor)
        yield from _keys_without_effect(path, sensor)
    zones = [zone.name for zone in context.scenario.world.zones]
    for key in getattr(sensor, "zone_keys", ()):
        names = getattr(sensor, key)
        yield from (unknown_zone((*path, key, k), name, zones) for k, name in enumerate(names) if name not in zones)
    if sensor.name == "cliff" and not sensor.zones:
        yield hint(
            "cliff-without-zones",
            path,
            "without 'zones' there is floor everywhere: nothing drops",
            fix="zones: [stairs], with a region of that name among world.zones",
        )
    if sensor.name == "contact2d" and context.scenario.world.collision_mode != "contact":
        yield hint(
            "contact-without-mode", path, "without 'collision_mode: contact' there are no contact forces to show"
        )


def _blind_lidar(context: Context, path: Path, sensor: Any, record: ObjectRecord) -> Iterator[Finding]:
    """Beams that end inside the robot's own body, which they do not see."""
    if not getattr(sensor, "is_lidar", False) or not has_fixed_shape(record.shape):
        return
    if math.hypot(*sensor.offset[:2]) > 0 or sensor.range_max > reach_of(record.shape):
        return
    x, y, radius = inner_disc(parts_of(record.shape))
    own = radius - math.hypot(x, y)
    if sensor.range_max <= own:
        yield warning(
            "lidar-blind",
            (*path, "range_max"),
            f"the beams are {sensor.range_max:g} m long and end inside the body, which extends {own:g} m: the lidar "
            "detects nothing before a collision",
            given=sensor.range_max,
            fix="range_max: 10; lengths are in metres",
        )


def _beams(path: Path, sensor: Any) -> Iterator[Finding]:
    """Numbers and spans of beams that have a surprising effect."""
    count, span, written = sensor.number, sensor.angle_range, sensor.model_fields_set
    if count == 1:
        if span > 0 and "angle_range" in written:
            where = (*path, "angle_range")
            yield hint(
                "lidar-beams", where, "a single beam points straight ahead, whatever the angle_range", given=span
            )
        return
    if span < _MIN_SPAN:
        yield hint(
            "lidar-beams",
            (*path, "angle_range"),
            f"all {count} beams point the same way"
            + (f": {span:g} rad are {math.degrees(span):.2g} degrees" if span > 0 else ""),
            given=span,
            fix="number: 1 for a range finder",
        )
        return
    spacing = span / (count - 1)
    meet = sensor.endpoint and FULL_TURN - span < spacing / 2
    if meet and "number" in written and not _whole_degrees(count - 1):
        yield hint(
            "lidar-ends-meet",
            (*path, "number"),
            f"over a full turn the first and the last of {count} beams point the same way: {count - 1} directions, "
            f"{math.degrees(spacing):.4g} degrees apart",
            given=count,
            fix=f"endpoint: false, for {count} directions",
            edit=Edit("replace", (*path, "endpoint"), False),
        )


def _whole_degrees(directions: int) -> bool:
    """Whether the spacing of this many directions is a multiple of half a degree, or a whole fraction of a degree."""
    return 720 % directions == 0 or directions % 360 == 0


def _keys_without_effect(path: Path, sensor: Any) -> Iterator[Finding]:
    """Keys that have no effect, given the other keys."""
    written = sensor.model_fields_set
    for key in ("std", "angle_std"):
        if key in written and getattr(sensor, key) > 0 and not sensor.noise:
            message = f"'{key}' has no effect without 'noise: true'"
            yield hint("lidar-noise-off", (*path, key), message, given=getattr(sensor, key), fix="noise: true")
    if sensor.name == "fmcw_lidar2d" and sensor.has_velocity:
        yield hint(
            "ignored-key",
            (*path, "has_velocity"),
            "this lidar measures radial velocities only: 'has_velocity' has no effect",
            fix="remove it, or use a lidar2d",
        )


def _fog(context: Context) -> Iterator[Finding]:
    world = context.scenario.world
    if not world.fog_map:
        if world.fog_map_resolution is not None:
            where = ("world", "fog_map_resolution")
            yield hint(
                "ignored-key", where, "'fog_map_resolution' has no effect without 'fog_map: true'", fix="fog_map: true"
            )
        return
    grid = context.resolved.grid
    cell = world.fog_map_resolution or (_DEFAULT_CELL if grid is None else grid.cell[0])
    cells = (world.width / cell) * (world.height / cell)
    if cells > _MAX_FOG_CELLS:
        key = "fog_map" if world.fog_map_resolution is None else "fog_map_resolution"
        least = math.sqrt(world.width * world.height / _MAX_FOG_CELLS)
        yield error(
            "fog-too-fine",
            ("world", key),
            f"the fog must have at most {_MAX_FOG_CELLS:,} cells, got {cells:.3g} of {cell:g} m",
            given=getattr(world, key),
            allowed=f"at most {_MAX_FOG_CELLS:,} cells",
            fix=f"fog_map_resolution: {least:.2g} or more",
        )
    sees = any(
        any(getattr(sensor, "is_lidar", False) for sensor in record.sensors)
        or (record.fov is not None and record.fov_radius is not None)
        for record in context.resolved.robots()
    )
    if not sees:
        yield hint(
            "fog-never-lifts",
            ("world", "fog_map"),
            "no robot has a lidar or a field of view, so the fog never lifts",
            fix="give a robot 'sensors: [{name: lidar2d}]', or 'fov' and 'fov_radius'",
        )
