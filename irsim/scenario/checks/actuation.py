"""Checks actuators: values per control, and keys that are given twice or have no effect."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres, seconds
from irsim.diagnostics.diagnostic import Edit, Path
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.checks._lengths import wrong_length
from irsim.scenario.messages.findings import Finding, error, hint, warning
from irsim.scenario.model.actuation import PER_CONTROL, Actuation, per_control
from irsim.scenario.resolve.body_size import top_speed
from irsim.scenario.resolve.resolved import ObjectRecord

_WAY = 0.05
"""Way that an object drives before a command takes effect, above which that is told [m]."""


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(finding for record in context.entry_objects for finding in _of_object(context, record))


def _of_object(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    options = record.actuation
    if options is None:
        return
    path = context.entry_path(record, "actuation")
    if (why := _why_unused(context, record)) is not None:
        yield warning(
            "actuation-unused",
            path,
            f"'{record.name}' {why}, so its actuation has no effect",
            fix="remove 'actuation'",
            edit=Edit("remove", path),
        )
        return
    wrong = False
    for key in PER_CONTROL:
        value = getattr(options, key)
        if isinstance(value, list) and len(value) != record.vel_dim:
            wrong = True
            here = (*path, key)
            edit = Edit("replace", here, value[0]) if len(value) == 1 else None
            written = f"{value[0]:g}" if edit else None
            yield wrong_length(record, here, value, or_number=True, written=written, edit=edit)
    if wrong:
        return
    if record.drive_tau > 0 and any(per_control(options.lag, record.vel_dim)):
        yield _lag_twice(context, record, (*path, "lag"))
    step_time = context.scenario.world.step_time
    if 0 < options.command_period <= step_time:
        yield hint(
            "actuation-unused",
            (*path, "command_period"),
            f"a command period of {options.command_period:g} s is not longer than a step of {step_time:g} s, so every "
            "step has its command",
            given=options.command_period,
            fix=f"write more than {step_time:g}, or remove 'command_period'",
        )
    yield from _never_moves(record, options, path)
    if sum(not other.unobstructed for other in context.resolved.objects) > 1:
        yield from _reacts_late(record, options, path, step_time)


def _why_unused(context: Context, record: ObjectRecord) -> str | None:
    if (why := context.why_undriven(record)) is not None:
        return why
    return "is moved by the calling program" if context.scenario.world.step_mode == "external" else None


def _lag_twice(context: Context, record: ObjectRecord, path: Path) -> Finding:
    assert record.actuation is not None
    own = getattr(record.kinematics, "tau", None) is not None
    old = (*context.entry_path(record, "kinematics"), "tau") if own else ("world", "drive_tau")
    written = (
        f"'tau' of its kinematics is {record.drive_tau:g}" if own else f"'world.drive_tau' is {record.drive_tau:g}"
    )
    return error(
        "lag-twice",
        path,
        f"the lag of '{record.name}' is given twice: {written}, too",
        given=record.actuation.lag,
        fix="remove 'tau', or this lag" if own else "write 'tau: 0' in its kinematics, or remove this lag",
        edit=Edit("remove", old) if own else None,
    )


def _never_moves(record: ObjectRecord, options: Actuation, path: Path) -> Iterator[Finding]:
    """A dead band, or a resolution, that no speed within the limits gets out of."""
    travel = getattr(record.kinematics, "speeds", 0)
    top = [max(abs(low), abs(high)) for low, high in zip(record.vel_min, record.vel_max, strict=False)][:travel]
    for key, share, what in (("dead_band", 1.0, "is executed as 0"), ("resolution", 0.5, "is rounded to 0")):
        sizes = per_control(getattr(options, key), travel)
        if len(top) == travel > 0 and all(share * size > most for size, most in zip(sizes, top, strict=True)):
            yield warning(
                "no-speed",
                (*path, key),
                f"every speed that the limits of '{record.name}' allow {what}, so it cannot move",
                given=getattr(options, key),
                fix=f"write less than {min(top) / share:g}",
            )


def _reacts_late(record: ObjectRecord, options: Actuation, path: Path, step_time: float) -> Iterator[Finding]:
    """A behavior that avoids others, and decides as if its commands were executed at once."""
    behavior: Any = record.active_behavior
    inner = getattr(behavior, "local", behavior)
    if not getattr(inner, "avoids", False):
        return
    held = options.command_period if options.command_period > step_time else 0.0
    time = held + max(per_control(options.delay, record.vel_dim)) + max(per_control(options.lag, record.vel_dim))
    way = time * top_speed(record)
    if not _WAY < way < math.inf:
        return
    copes = inner.name in ("orca", "rvo")
    yield hint(
        "reacts-late",
        path,
        f"'{record.name}' drives {metres(way)} before a command takes effect ({seconds(time)}); {inner.name} does not "
        "reckon with that",
        fix="lower vel_max, or leave more room" if copes else "orca and rvo cope best; else lower vel_max",
    )
