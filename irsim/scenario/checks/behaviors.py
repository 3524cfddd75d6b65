"""Checks behaviors: whether they are known, can move their object, and have options that take effect."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from irsim.components.options import BehaviorOptions, CustomOptions
from irsim.diagnostics.diagnostic import Edit, is_slip_of, nearest
from irsim.options.registry import BEHAVIORS, CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, CustomBehaviors
from irsim.options.selection import component_meant
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.lookup import at
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

_OWN = (
    "use one of the allowed names, or register your own behavior in Python before the scenario is read "
    "(irsim.register_behavior, or --import MODULE on the command line)"
)
_SPEEDS = {
    "sfm": ("vmax",),
    "rvo": ("vxmax", "vymax"),
    "orca": ("maxSpeed",),
    "avocado": ("maxSpeed",),
    "footprint_orca": ("maxSpeed",),
}
"""Keys with the highest speed that a behavior asks for."""


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    for key, table in (("behavior", CUSTOM_BEHAVIORS), ("group_behavior", CUSTOM_GROUP_BEHAVIORS)):
        options = getattr(record, key)
        if options is None:
            continue
        if isinstance(options, CustomOptions):
            yield from _unknown_name(context, record, key, table)
        yield from _goal_options(context, record, key, options)
        if options.name == "rvo":
            yield from _rvo_acce(context, record, key, options)
        yield from _speed_above_limits(context, record, key, options)
        yield from _misplaced_keys(context, record, key, options)
    if record.kinematics is None and (record.behavior or record.group_behavior) is not None:
        key = "behavior" if record.behavior is not None else "group_behavior"
        yield warning(
            "behavior-without-kinematics",
            context.entry_path(record, key),
            f"an object without kinematics never moves, whatever its {key.replace('_', ' ')}",
            fix=_drive_fix(context, record),
        )
    if record.behavior is not None or record.group_behavior is not None:
        return
    driven = record.group in context.driven_groups
    goal = next((key for key in ("goal", "waypoints") if context.is_given(record, key)), None)
    if record.kinematics is None and record.role == "robot" and goal and not context.entry(record.path).static:
        yield warning(
            "behavior-without-kinematics",
            context.entry_path(record, goal),
            "a robot without kinematics never moves, so it cannot reach its goal",
            fix=_drive_fix(context, record),
        )
    elif not driven and not record.static and (record.role == "robot" or (record.kinematics is not None and goal)):
        unless = "the program gives it actions" if record.role == "robot" else "the program moves it"
        yield hint(
            "no-behavior",
            record.path,
            f"this {record.role} has no behavior: it stands still unless {unless}",
            fix="nothing to fix if it is meant to stand still or a program moves it; else add 'behavior: {name: dash}'",
            edit=Edit("add", (*record.path, "behavior"), {"name": "dash"}),
        )


def _drive_fix(context: Context, record: ObjectRecord) -> str:
    """The fix for an object without kinematics, or with kinematics that never move."""
    drives = "(or omni, omni_angular, acker)"
    if "kinematics" not in at(context.data, record.path):
        return f"add 'kinematics: {{name: diff}}' {drives}"
    written = at(context.data, context.entry_path(record, "kinematics"))
    return f"write 'kinematics: {{name: diff}}' {drives} instead of {flow(written)}"


def _unknown_name(context: Context, record: ObjectRecord, key: str, table: CustomBehaviors) -> Iterator[Finding]:
    options: Any = getattr(record, key)
    drive = getattr(record.kinematics, "name", "static")
    if table.has(drive, options.name) or record.kinematics is None:
        return
    known = sorted({*_built_in(key), *table.names(drive)})
    elsewhere = table.drives(options.name)
    path = (*context.entry_path(record, key), "name")
    if elsewhere:
        yield error(
            "behavior-for-other-drive",
            path,
            f"'{options.name}' is registered for {', '.join(elsewhere)}, not for {drive}",
            given=options.name,
            allowed=known,
            fix=f"register it for '{drive}' too, or use the kinematics it is registered for",
            tolerated=True,
        )
        return
    near = component_meant(options.name, known) or nearest(options.name, known)
    fix = f"name: {near}" if near else _OWN
    edit = Edit("replace", path, near, safe=is_slip_of(options.name, near)) if near else None
    if options.name in ("wander", "loop"):
        plain = "dash" if key == "behavior" else "orca"
        fix = f"write {{name: {plain}, {options.name}: true}}: '{options.name}' is a key of every behavior"
        whole = {**options.model_dump(exclude_unset=True), "name": plain, options.name: True}
        edit = Edit("replace", path[:-1], whole) if plain == "dash" and not options.model_extra else None
    yield error(
        "unknown-behavior",
        path,
        f"'{options.name}' is not a {'group ' if key == 'group_behavior' else ''}behavior",
        given=options.name,
        allowed=known,
        fix=fix,
        edit=edit,
        tolerated=True,
    )


def _built_in(key: str) -> list[str]:
    if key == "behavior":
        return BEHAVIORS.names()
    return [feature.name for feature in BEHAVIORS.features() if getattr(feature.options, "in_group", False)]


def _goal_options(context: Context, record: ObjectRecord, key: str, options: Any) -> Iterator[Finding]:
    path = context.entry_path(record, key)
    if options.wander and options.loop:
        yield warning(
            "wander-and-loop",
            (*path, "loop"),
            "'wander' and 'loop' exclude each other: only 'wander' takes effect",
            fix="keep one of them",
            edit=Edit("remove", (*path, "loop")),
        )
    if options.range_low is None and options.range_high is None:
        return
    low, high = record.range_low, record.range_high
    written = "range_low" if options.range_low is not None else "range_high"
    if any(a > b for a, b in zip(low, high, strict=True)):
        yield error(
            "range-order",
            (*path, written),
            f"range_low must not exceed range_high, got {low} and {high}",
            given=getattr(options, written),
            fix="lower range_low or raise range_high",
        )
        return
    x0, y0, x1, y1 = context.scenario.world.bounds
    below, above = (p[0] < x0 or p[1] < y0 or p[0] > x1 or p[1] > y1 for p in (low, high))
    if options.wander and (below or above):
        yield hint(
            "wander-outside",
            (*path, "range_low" if below else "range_high"),
            f"random goals may lie outside the world [{x0:g}, {x1:g}] × [{y0:g}, {y1:g}]",
            fix="remove range_low and range_high to use the extent of the world",
        )


def _misplaced_keys(context: Context, record: ObjectRecord, key: str, options: Any) -> Iterator[Finding]:
    """Keys written inside the ``local`` behavior of ``follow`` although ``follow`` itself reads them."""
    local: Any = getattr(options, "local", None)
    path = context.entry_path(record, key)
    written: Any = at(context.data, path)
    if not isinstance(local, BehaviorOptions) or not isinstance(written, Mapping):
        return
    inner = written.get("local")
    lost = [
        name
        for name in BehaviorOptions.model_fields
        if name != "name" and name in local.model_fields_set and getattr(local, name) != getattr(options, name)
    ]
    if not isinstance(inner, Mapping) or not lost:
        return
    rest = {name: value for name, value in inner.items() if name not in lost}
    moved = {**written, "local": rest, **{name: inner[name] for name in lost if name not in written}}
    for name in lost:
        there = name in written
        yield warning(
            "ignored-key",
            (*path, "local", name),
            f"within 'local' the key '{name}' has no effect: '{options.name}' reads it one level up",
            given=inner[name],
            fix=f"remove it: '{name}' is given there already"
            if there
            else f"{key}: {{name: {options.name}, {name}: {flow(inner[name])}, local: {flow(rest)}}}",
            edit=Edit("remove", (*path, "local", name)) if there else Edit("replace", path, moved),
        )


def _speed_above_limits(context: Context, record: ObjectRecord, key: str, options: Any) -> Iterator[Finding]:
    """Speed options of a behavior that are above the limits of the drive."""
    speeds = getattr(record.kinematics, "speeds", 0)
    limits = [max(abs(low), abs(high)) for low, high in zip(record.vel_min, record.vel_max, strict=False)]
    if speeds == 0 or len(limits) < 2 or record.static:
        return
    top = limits[0] if speeds == 1 else math.hypot(*limits[:2])
    for name in _SPEEDS.get(options.name, ()):
        value, usual = getattr(options, name), type(options).model_fields[name].default
        if name not in options.model_fields_set or value is None or not max(top, usual or 0.0) < value < math.inf:
            continue
        faster = [value, *record.vel_max[1:]] if top == limits[0] else [value, value, *record.vel_max[2:]]
        yield hint(
            "speed-capped",
            (*context.entry_path(record, key), name),
            f"'{options.name}' may ask for {value:g} m/s, but the limits of '{record.name}' allow {top:.3g} m/s",
            given=value,
            fix=f"'vel_max: {flow(faster)}' of the object, or {name}: {top:.3g}",
        )
        return


def _rvo_acce(context: Context, record: ObjectRecord, key: str, options: Any) -> Iterator[Finding]:
    if "acce" in options.model_fields_set and options.acce >= max(options.vxmax, options.vymax):
        rate = options.acce / context.scenario.world.step_time
        yield hint(
            "rvo-acce",
            (*context.entry_path(record, key), "acce"),
            f"'acce' of rvo is m/s per step, not m/s²: {options.acce:g} allows {rate:g} m/s² and so limits nothing",
            given=options.acce,
            fix=f"for {options.acce:g} m/s² write {options.acce * context.scenario.world.step_time:g}",
        )
