"""Units: angles that look like degrees, lengths that look like centimetres, times that look like milliseconds."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.diagnostics import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.checks.overlap import reach_of
from irsim.scenario.extent import has_fixed_shape, inner_disc, parts_of
from irsim.scenario.findings import Finding, hint, warning
from irsim.scenario.objects import ObjectRecord
from irsim.scenario.wording import flow

_TURN = 6.3
_FASTEST_TURN = 20.0
"""Three turns a second [rad/s]: hardly a robot is meant to be faster."""
_FASTEST = 45.0
"""162 km/h [m/s]."""
_LONGEST_STEP = 1.0
_WIDEST = 20.0
"""The longest lorries [m]."""


def check(context: Context) -> Iterator[Finding]:
    """One finding per place and code."""
    yield from _times(context)
    seen: set[tuple[str, Path]] = set()
    for record in context.written:
        for finding in _of_object(context, record):
            key = (finding.diagnostic.code, finding.diagnostic.path)
            if key not in seen:
                seen.add(key)
                yield finding
    for path, entry, _ in context.entries():
        yield from _ranges((*path, "distribution"), entry.distribution)


def _times(context: Context) -> Iterator[Finding]:
    world = context.scenario.world
    if world.step_time >= _LONGEST_STEP:
        likely = world.step_time / 1000
        meant = f"; {world.step_time:g} ms are {likely:g}" if world.step_time >= 5 else ""
        yield hint(
            "step-time-long",
            ("world", "step_time"),
            f"one step lasts {world.step_time:g} s, in which everything drives blindly{meant}",
            given=world.step_time,
            fix="step_time: 0.1; times are in seconds",
        )


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    yield from _lengths(context, record)
    yield from _speeds(context, record)
    for key in ("behavior", "group_behavior"):
        if context.given(record, key):
            yield from _ranges(context.entry_path(record, key), getattr(record, key))
    if context.given(record, "sensors"):
        for index, sensor in enumerate(record.sensors):
            where = (*context.entry_path(record, "sensors"), index)
            yield from _heading((*where, "offset"), list(getattr(sensor, "offset", None) or []))
    shape: Any = record.shape
    if shape.name == "compound":
        for index, part in enumerate(shape.parts):
            yield from _heading((*context.entry_path(record, "shape"), "parts", index, "pose"), list(part.pose))


def _lengths(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Bodies that have no room in their world, or that no robot has."""
    if not context.given(record, "shape") or record.role != "robot" or not has_fixed_shape(record.shape):
        return
    world = context.scenario.world
    reach = reach_of(record.shape)
    if 2 * reach < min(world.width, world.height, _WIDEST) or not math.isfinite(reach):
        return
    width = 2 * inner_disc(parts_of(record.shape))[2]
    if 2 * reach > _WIDEST or width >= min(world.width, world.height):
        why = (
            f"does not fit into the world ({world.width:g} m × {world.height:g} m)"
            if width >= min(world.width, world.height)
            else "is longer than any lorry"
        )
        yield warning(
            "looks-like-centimetres",
            context.entry_path(record, "shape"),
            f"'{record.name}' is about {2 * reach:.3g} m long and {why}",
            fix=f"lengths are in metres: {width:.3g} cm are {width / 100:.3g}",
        )


def _speeds(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    rows: tuple[str, ...] = getattr(record.kinematics, "control_rows", ())
    if len(rows) != len(record.vel_max) or not context.given(record, "vel_max"):
        return
    where = context.entry_path(record, "vel_max")
    for row, value in zip(rows, record.vel_max, strict=True):
        if not math.isfinite(value):
            continue
        if ("yaw" in row or "angular" in row) and value > _FASTEST_TURN:
            right = [*record.vel_max]
            right[rows.index(row)] = round(math.radians(value), 4)
            yield hint(
                "rate-in-degrees",
                where,
                f"{value:g} rad/s are {value / 2 / math.pi:.3g} turns a second",
                given=record.vel_max,
                fix=f"rates of turning are in rad/s: {flow(right)} for {value:g} degrees a second",
            )
        elif "yaw" not in row and "angular" not in row and "steer" not in row and value > _FASTEST:
            yield hint(
                "speed-in-centimetres",
                where,
                f"{value:g} m/s are {value * 3.6:g} km/h",
                given=record.vel_max,
                fix=f"speeds are in m/s: {value:g} cm/s are {value / 100:g}",
            )


def _ranges(path: Path, options: Any) -> Iterator[Finding]:
    """Headings among the bounds of random poses."""
    for key in ("range_low", "range_high"):
        yield from _heading((*path, key), list(getattr(options, key, None) or []))


def _heading(path: Path, pose: list[float]) -> Iterator[Finding]:
    if len(pose) > 2 and abs(pose[2]) > _TURN and pose[2] == int(pose[2]):
        yield hint(
            "heading-in-degrees",
            path,
            f"a heading of {pose[2]:g} radians is {abs(pose[2]) / (2 * math.pi):.1f} turns",
            given=pose,
            fix=f"angles are in radians: {pose[2]:g} degrees are {math.radians(pose[2]):.5g}",
        )
