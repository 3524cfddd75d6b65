"""Finds objects that move or turn so far in one step that their motion becomes coarse."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.messages.findings import Finding, hint
from irsim.scenario.model.world import WorldModel
from irsim.scenario.resolve.body_size import has_fixed_shape, thickness, top_speed
from irsim.scenario.resolve.resolved import ObjectRecord

MAX_MOVE_SHARE = 0.5
"""Share of the smallest extent of a body by which it may move in a step without a hint."""
MAX_TURN = 0.5
"""Angle by which it may turn in a step [rad]: its rim then moves by a quarter of its size."""
_UNREAL = 10.0
"""Extents, or radians, per step above which limits are given in wrong units, which other checks report."""


def check(context: Context) -> Iterator[Finding]:
    """One finding per entry."""
    yield from distinct(_coarse_steps(context))


def _coarse_steps(context: Context) -> Iterator[Finding]:
    world = context.scenario.world
    if world.step_mode == "external":
        return
    dt = world.step_time
    for record in context.entry_objects:
        if record.kinematics is None or record.static or record.recorded or not has_fixed_shape(record.shape):
            continue
        size, speed, rate = thickness(record.shape), _usual_speed(record), _top_yaw_rate(record)
        share, turn = speed * dt / size if 0 < size < math.inf else 0.0, rate * dt
        euler = world.integration == "euler" and speed > 0
        coarse_turn = euler and MAX_TURN < turn <= _UNREAL
        coarse_move = MAX_MOVE_SHARE * (1 + 1e-9) < share <= _UNREAL
        if not (coarse_move or coarse_turn):
            continue
        longest = _rounded_down(
            min(MAX_MOVE_SHARE * dt / share if share > 0 else math.inf, MAX_TURN / rate if euler and rate > 0 else dt)
        )
        shorter = f"world.step_time: {longest:g} or less"
        written = context.is_given(record, "vel_max")
        where = context.entry_path(record, "vel_max") if written else record.path
        if coarse_turn:
            yield hint(
                "coarse-steps",
                where,
                f"'{record.name}' turns by up to {turn:.2g} rad in a step of {dt:g} s, so that its rim moves by more "
                f"than a quarter of its size, but Euler's law moves it straight within the step: on a circle its "
                f"position is off by up to {metres(speed * dt)}",
                given=record.vel_max,
                fix=shorter if coarse_move else f"world.integration: exact, or {shorter}",
                edit=None if coarse_move else Edit("add", ("world", "integration"), "exact"),
            )
        else:
            yield hint(
                "coarse-steps",
                where,
                f"'{record.name}' moves by up to {metres(speed * dt)} in a step of {dt:g} s, more than half of its "
                f"size ({metres(size)}): {_only(world)} only that often",
                given=record.vel_max,
                fix=shorter,
            )


def _only(world: WorldModel) -> str:
    """Features that act once in a step."""
    within = world.contacts == "swept" or world.collision_mode == "contact"
    return "it decides" if within else "it decides, and contacts are judged,"


def _usual_speed(record: ObjectRecord) -> float:
    """Top speed straight ahead or sideways [m/s]: only few behaviors use both at once."""
    speed = top_speed(record)
    if getattr(record.kinematics, "speeds", 0) != 2:
        return speed
    return min(speed, max(abs(limit) for limit in (*record.vel_min[:2], *record.vel_max[:2])))


def _top_yaw_rate(record: ObjectRecord) -> float:
    """Fastest turn [rad/s]; 0 for drives that do not turn, or of user code."""
    drive: Any = record.kinematics
    if drive.speeds == 0 or not drive.turns or min(len(record.vel_min), len(record.vel_max)) <= drive.speeds:
        return 0.0
    limit = float(max(abs(record.vel_min[drive.speeds]), abs(record.vel_max[drive.speeds])))
    if not drive.steered:
        return limit
    psi = max(drive.steering(record.vel_min, record.vel_max))
    if psi >= math.pi / 2:
        return 0.0  # another check reports such an angle
    return float(top_speed(record) * math.tan(psi) / (record.wheelbase or 1.0))


def _rounded_down(value: float) -> float:
    """A number of one digit, at most ``value``."""
    digit = 10.0 ** math.floor(math.log10(value))
    return round(math.floor(value / digit * (1 + 1e-9)) * digit, 12)
