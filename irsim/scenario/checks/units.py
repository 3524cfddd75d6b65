"""Checks units: angles that may be degrees, lengths that may be centimetres, times that may be milliseconds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, hint, warning
from irsim.scenario.resolve.body_size import has_fixed_shape, inner_disc, reach_of, top_speed
from irsim.scenario.resolve.kernels import parts_of
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

_MAX_HEADING = 6.3
"""Largest heading that is surely in radians: a full turn, rounded up [rad]."""
_MAX_TURN_RATE = 20.0
"""Highest plausible turn rate, about three turns per second [rad/s]."""
_MAX_SPEED = 45.0
"""Highest plausible speed, 162 km/h [m/s]."""
_MAX_STEP_TIME = 1.0
"""Longest plausible period of one step [s]."""
_MAX_LENGTH = 20.0
"""Length of the longest lorries [m]; a longer robot may be a ship, or given in centimetres."""
_MAX_SHARE_OF_WORLD = 0.5
"""Length of a plausible ship, as a share of the shorter side of the world."""
_MAX_DISTANCE_RATIO = 2.0
"""Distance of a plausible obstacle from the world, in multiples of the longer side of the world."""
_EDGE_TOLERANCE = 1e-6
"""Distance from the edge within which a corner is inside the world [m]."""
_MAX_ANGLE_STD = 0.5
"""Largest plausible error of a beam's direction [rad]."""
_MAX_BEAM_RATIO = 100.0
"""Length of a plausible beam, in multiples of the longer side of the world."""
_MAX_OFFSET_RATIO = 5.0
"""Plausible offset of a sensor, in multiples of the reach of the body."""
_MIN_REACH = 0.1
"""Smallest reach of a body that the offset is compared with [m]."""


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from _times(context)
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))
    for path, entry, _ in context.entries():
        yield from _ranges((*path, "distribution"), entry.distribution)


def _times(context: Context) -> Iterator[Finding]:
    world = context.scenario.world
    if world.step_time >= _MAX_STEP_TIME:
        likely = world.step_time / 1000
        meant = f"; {world.step_time:g} ms are {likely:g} s" if world.step_time >= 5 else ""
        speeds = (top_speed(record) for record in context.entry_objects if record.kinematics is not None)
        far = max(speeds, default=0.0) * world.step_time
        yield (warning if max(world.width, world.height) <= far < math.inf else hint)(
            "step-time-long",
            ("world", "step_time"),
            f"one step lasts {world.step_time:g} s, and nothing can react during a step{meant}",
            given=world.step_time,
            fix="step_time: 0.1; times are in seconds",
        )


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    yield from _lengths(context, record)
    yield from _speeds(context, record)
    for key in ("behavior", "group_behavior"):
        if context.is_given(record, key):
            yield from _ranges(context.entry_path(record, key), getattr(record, key))
    if context.is_given(record, "sensors"):
        for index, sensor in enumerate(record.sensors):
            where = (*context.entry_path(record, "sensors"), index)
            yield from _heading((*where, "offset"), list(getattr(sensor, "offset", None) or []))
            yield from _sensor(context, record, where, sensor)
    shape: Any = record.shape
    if shape.name == "compound":
        for index, part in enumerate(shape.parts):
            yield from _heading((*context.entry_path(record, "shape"), "parts", index, "pose"), list(part.pose))


def _lengths(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Bodies that do not fit into their world, or are larger than any robot."""
    if not context.is_given(record, "shape") or not has_fixed_shape(record.shape):
        return
    if record.role != "robot":
        yield from _obstacle(context, record)
        return
    world = context.scenario.world
    reach = reach_of(record.shape)
    if 2 * reach < min(world.width, world.height, _MAX_LENGTH) or not math.isfinite(reach):
        return
    width = 2 * inner_disc(parts_of(record.shape))[2]
    if 2 * reach > _MAX_LENGTH or width >= min(world.width, world.height):
        why = (
            f"does not fit into the world ({world.width:g} m × {world.height:g} m)"
            if width >= min(world.width, world.height)
            else "is longer than any lorry"
        )
        may_be = width < min(world.width, world.height) and 2 * reach < _MAX_SHARE_OF_WORLD * min(
            world.width, world.height
        )
        yield (hint if may_be else warning)(
            "looks-like-centimetres",
            context.entry_path(record, "shape"),
            f"'{record.name}' is about {metres(2 * reach)} long and {why}",
            fix=f"lengths are in metres: {2 * reach:.3g} cm are {2 * reach / 100:.3g}",
        )


def _obstacle(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Obstacles that fill their world, and obstacles far outside it."""
    world, reach = context.scenario.world, reach_of(record.shape)
    if record.unobstructed or not math.isfinite(reach):
        return
    side = min(world.width, world.height)
    width = 2 * inner_disc(parts_of(record.shape))[2] if 2 * reach > side else 0.0
    if width >= side:
        yield hint(
            "looks-like-centimetres",
            context.entry_path(record, "shape"),
            f"'{record.name}' is {metres(width)} thick, but the world is only {world.width:g} m × {world.height:g} m",
            fix=f"lengths are in metres: {width:.3g} cm are {width / 100:.3g}",
        )
    elif record.shape.name in ("polygon", "linestring"):
        findings = list(_outline(context, record))
        yield from findings
        if findings:
            return
    x0, y0, x1, y1 = world.bounds
    x, y = record.state[:2]
    if not context.is_given(record, "state"):
        return
    far = math.hypot(max(x0 - x, 0.0, x - x1), max(y0 - y, 0.0, y - y1)) - reach
    if far > _MAX_DISTANCE_RATIO * max(world.width, world.height) and x0 <= x / 100 <= x1 and y0 <= y / 100 <= y1:
        yield hint(
            "looks-like-centimetres",
            context.entry_path(record, "state"),
            f"'{record.name}' is {metres(far)} outside the world, which is {world.width:g} m × {world.height:g} m",
            fix=f"lengths are in metres: ({x:g}, {y:g}) cm are ({x / 100:g}, {y / 100:g})",
        )


def _outline(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Outlines that reach far outside the world but, read as centimetres, lie inside it."""
    world, (x, y, theta) = context.scenario.world, record.state[:3]
    x0, y0, x1, y1 = world.bounds
    cos, sin = math.cos(theta), math.sin(theta)
    corners = [
        (x + cos * u - sin * v, y + sin * u + cos * v)
        for part in parts_of(record.shape)
        for u, v in getattr(part, "vertices", ())
    ]
    inside = all(
        x0 - _EDGE_TOLERANCE <= u / 100 <= x1 + _EDGE_TOLERANCE
        and y0 - _EDGE_TOLERANCE <= v / 100 <= y1 + _EDGE_TOLERANCE
        for u, v in corners
    )
    far = max((max(u - x1, v - y1, x0 - u, y0 - v) for u, v in corners), default=0.0)
    if not inside or far <= _MAX_DISTANCE_RATIO * max(world.width, world.height):
        return
    u, v = max(corners, key=lambda corner: max(abs(corner[0]), abs(corner[1])))
    yield hint(
        "looks-like-centimetres",
        context.entry_path(record, "shape"),
        f"'{record.name}' reaches ({u:.4g}, {v:.4g}), but the world is only {world.width:g} m × {world.height:g} m",
        fix=f"lengths are in metres: ({u:.4g}, {v:.4g}) cm are ({u / 100:.4g}, {v / 100:.4g})",
    )


def _sensor(context: Context, record: ObjectRecord, path: Path, sensor: Any) -> Iterator[Finding]:
    """Beams far longer than the world, very inexact beams, and sensors far away from their robot."""
    world: Any = context.scenario.world
    written: Any = getattr(sensor, "model_fields_set", ())
    reach, offset = getattr(sensor, "range_max", 0.0), getattr(sensor, "offset", None) or [0.0, 0.0]
    if "range_max" in written and _MAX_BEAM_RATIO * max(world.width, world.height) <= reach < math.inf:
        yield hint(
            "looks-like-centimetres",
            (*path, "range_max"),
            f"the beams are {reach:g} m long in a world of {world.width:g} m × {world.height:g} m",
            given=reach,
            fix=f"lengths are in metres: {reach:g} cm are {reach / 100:g}, {reach:g} mm are {reach / 1000:g}",
        )
    spread = getattr(sensor, "angle_std", 0.0)
    if "angle_std" in written and spread > _MAX_ANGLE_STD:
        yield hint(
            "heading-in-degrees",
            (*path, "angle_std"),
            f"beams that deviate by {spread:g} rad, which is {math.degrees(spread):.3g} degrees, may point anywhere",
            given=spread,
            fix=f"angles are in radians: {spread:g} degrees are {math.radians(spread):.4g}",
        )
    away = math.hypot(*offset[:2])
    if has_fixed_shape(record.shape) and away > _MAX_OFFSET_RATIO * max(reach_of(record.shape), _MIN_REACH):
        yield hint(
            "looks-like-centimetres",
            (*path, "offset"),
            f"this sensor is {away:g} m away from the middle of '{record.name}', but the body extends only "
            f"{metres(reach_of(record.shape))}",
            given=offset,
            fix=f"lengths are in metres: {away:g} cm are {away / 100:g}",
        )


def _speeds(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    rows: tuple[str, ...] = getattr(record.kinematics, "control_rows", ())
    if len(rows) != len(record.vel_max) or not context.is_given(record, "vel_max"):
        return
    where = context.entry_path(record, "vel_max")
    by_rate = getattr(record.kinematics, "mode", "") == "angular"
    for row, value in zip(rows, record.vel_max, strict=True):
        if not math.isfinite(value):
            continue
        if ("yaw" in row or "angular" in row or (by_rate and row == "steer")) and value > _MAX_TURN_RATE:
            right = [*record.vel_max]
            right[rows.index(row)] = round(math.radians(value), 4)
            yield hint(
                "rate-in-degrees",
                where,
                f"{value:g} rad/s are {value / 2 / math.pi:.3g} turns per second",
                given=record.vel_max,
                fix=f"turn rates are in rad/s: {flow(right)} for {value:g} degrees per second",
            )
        elif "yaw" not in row and "angular" not in row and "steer" not in row and value > _MAX_SPEED:
            yield hint(
                "speed-in-centimetres",
                where,
                f"{value:g} m/s are {value * 3.6:g} km/h",
                given=record.vel_max,
                fix=f"speeds are in m/s: {value:g} km/h are {value / 3.6:.4g}, {value:g} cm/s are {value / 100:g}",
            )


def _ranges(path: Path, options: Any) -> Iterator[Finding]:
    """Check the headings of the bounds of random poses."""
    for key in ("range_low", "range_high", "goal_low", "goal_high"):
        yield from _heading((*path, key), list(getattr(options, key, None) or []))


def _heading(path: Path, pose: list[float]) -> Iterator[Finding]:
    if len(pose) > 2 and abs(pose[2]) > _MAX_HEADING and pose[2] == int(pose[2]):
        yield hint(
            "heading-in-degrees",
            path,
            f"a heading of {pose[2]:g} radians is {abs(pose[2]) / (2 * math.pi):.1f} turns",
            given=pose,
            fix=f"angles are in radians: {pose[2]:g} degrees are {math.radians(pose[2]):.5g}",
        )
