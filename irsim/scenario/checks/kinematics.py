"""Checks drives: control vectors and limits, heading interval, surprising parameters."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.components.options import CustomOptions
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.checks._lengths import wrong_length
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

_CONTROL_KEYS = ("velocity", "vel_min", "vel_max", "acce")
_BROADCAST = ("vel_min", "vel_max")  # IR-SIM takes a single number for all components
_ROUNDING = 1e-6
"""Rounding error allowed in a full turn [rad]."""
_QUARTER_TURN = 1.58
"""A quarter turn, rounded up [rad]."""


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    wrong = [finding for key in _CONTROL_KEYS if (finding := _wrong_length(context, record, key)) is not None]
    yield from wrong
    if not wrong:
        yield from _limits_order(context, record)
    if context.is_given(record, "angle_range"):
        yield from _angle_range(context, record)
    if record.kinematics is None:
        return
    options: Any = record.kinematics
    yield from _unfit(context, record)
    if options.steered and not record.wheelbase:
        yield hint(
            "wheelbase-default",
            (*context.entry_path(record, "kinematics"), "name"),
            "no 'wheelbase' is given: 1 m is used",
            fix="add 'wheelbase' to the shape or to the kinematics",
        )
    length = getattr(record.shape, "length", None)
    if options.steered and record.wheelbase and length is not None and record.wheelbase > length:
        yield hint(
            "wheelbase-over-length",
            context.entry_path(record, "shape" if record.shape.wheelbase is not None else "kinematics"),
            f"the axles are {record.wheelbase:g} m apart, but the body is only {length:g} m long",
            fix=f"use a length of more than {record.wheelbase:g}, or a wheelbase of about {round(0.6 * length, 3):g}",
        )
    steering = max(abs(record.vel_min[1]), abs(record.vel_max[1])) if record.vel_dim > 1 else 0.0
    if not wrong and options.steered and not options.pivots and options.mode != "angular" and steering >= math.pi / 2:
        key = "vel_max" if context.is_given(record, "vel_max") else "vel_min"
        yield warning(
            "steering-limit",
            context.entry_path(record, key),
            f"a steering angle of up to {steering:g} rad is a quarter turn or more",
            given=getattr(record, key),
            fix=f"angles are in radians: {steering:g} degrees are {math.radians(steering):.4g}",
        )
    if not options.pivots and (getattr(options, "psi_max", None) or 0.0) > _QUARTER_TURN:
        yield warning(
            "steering-limit",
            (*context.entry_path(record, "kinematics"), "psi_max"),
            f"a steering angle of up to {options.psi_max:g} rad is a quarter turn or more",
            given=options.psi_max,
            fix=f"angles are in radians: {options.psi_max:g} degrees are {math.radians(options.psi_max):.4g}",
        )
    if options.speeds == 2 and options.noise:
        yield hint(
            "omni-noise",
            (*context.entry_path(record, "kinematics"), "noise"),
            "this noise does not vanish at standstill: the object trembles even when commanded to rest",
            fix="lower 'alpha', or remove 'noise'",
        )


def _unfit(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Limits of a drive with speeds of its own: it is not pushed, and behaviors do not drive it by accelerations."""
    options: Any = record.kinematics
    path = context.entry_path(record, "kinematics")
    if options.coasts and context.scenario.world.collision_mode == "contact":
        yield error(
            "drive-not-pushed",
            path,
            f"'{options.name}' has speeds of its own, which contacts cannot change: 'collision_mode: contact' needs "
            "another drive",
            given=options.name,
            fix=f"kinematics: {{name: {'acker' if options.steered else 'diff'}}}, or another 'collision_mode'",
        )
    behavior = record.active_behavior
    if options.mode == "acceleration" and behavior is not None and not isinstance(behavior, CustomOptions):
        yield error(
            "drive-by-acceleration",
            (*path, "mode"),
            f"the behavior '{getattr(behavior, 'name', '')}' gives speeds, but 'mode: acceleration' takes "
            "accelerations",
            given=options.mode,
            allowed=["steer", "angular"],
            fix="mode: steer",
            edit=Edit("replace", (*path, "mode"), "steer"),
        )


def _wrong_length(context: Context, record: ObjectRecord, key: str) -> Finding | None:
    values = _written_vector(context, record, key)
    if values is None or len(values) == record.vel_dim or record.kinematics is None:  # unused without a drive
        return None
    path, wanted = context.entry_path(record, key), values * record.vel_dim
    same = Edit("replace", path, wanted) if key in _BROADCAST and len(values) == 1 else None
    carry_on = _start_velocity(context, record, values) if key == "velocity" else same
    return wrong_length(record, path, values, written=flow(wanted), edit=same, carry_on=carry_on)


def _start_velocity(context: Context, record: ObjectRecord, values: list[float]) -> Edit | None:
    """The velocity that 2.12 reads for an object with a behavior: cut, padded, or one number for each component."""
    decides = record.behavior is not None or record.group_behavior is not None
    limited = context.is_given(record, "acce") and len(values) > 1
    if not decides or limited or not values:
        return None
    read = values * record.vel_dim if len(values) == 1 else [*values, *[0.0] * record.vel_dim][: record.vel_dim]
    return Edit("replace", context.entry_path(record, "velocity"), read)


def _written_vector(context: Context, record: ObjectRecord, key: str) -> list[float] | None:
    """The vector that the file gives this object."""
    value: Any = getattr(context.entry(record.path), key)
    if isinstance(value, list) and any(isinstance(item, list) or item is None for item in value):
        value = value[min(record.index, len(value) - 1)]
    return value if value is None else list(value)


def _limits_order(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    for i, (low, high) in enumerate(zip(record.vel_min, record.vel_max, strict=True)):
        if low > high:
            written = "vel_min" if context.is_given(record, "vel_min") else "vel_max"
            other = "" if context.is_given(record, "vel_min") else ", which is the default"
            yield error(
                "limits-order",
                context.entry_path(record, written),
                f"component {i}: the lower limit {low:g}{other} is above the upper limit {high:g}",
                given=getattr(record, written),
                fix="no number of vel_min may exceed the one in vel_max",
            )
            return
    if record.kinematics is None or context.is_given(record, "vel_min") or not context.is_given(record, "vel_max"):
        return
    if any(high > 1 for high in record.vel_max):
        lower = [-value for value in record.vel_max]
        rows: tuple[str, ...] = getattr(record.kinematics, "control_rows", ())
        sideways = len(rows) > 1 and "lateral" in rows[1]
        turning = any("yaw" in row or "angular" in row or "steer" in row for row in rows)
        ways = ["backwards", *(["sideways"] if sideways else []), *(["turning right"] if turning else [])]
        yield hint(
            "vel-min-default",
            context.entry_path(record, "vel_max"),
            "only the upper limits are raised: vel_min stays at -1 for each component",
            given=record.vel_max,
            fix=f"add 'vel_min: {flow(lower)}' if it should be as fast {' and '.join(ways)}",
            edit=Edit("add", (*record.path, "vel_min"), lower),
        )


def _angle_range(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    values = _written_vector(context, record, "angle_range") or [-math.pi, math.pi]
    if abs(values[1] - values[0] - 2 * math.pi) > _ROUNDING:
        path = context.entry_path(record, "angle_range")
        yield error(
            "angle-range",
            path,
            f"'angle_range' must be one full turn wide, got {values[1] - values[0]:.6g} rad",
            given=values,
            allowed="[low, low + 6.283185307]",
            fix=f"[{values[0]:g}, {values[0] + 2 * math.pi:.9f}], or [-3.141592654, 3.141592654]",
            edit=Edit("replace", path, [values[0], values[0] + 2 * math.pi]),
        )
