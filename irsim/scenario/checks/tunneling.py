"""Finds objects that can pass through others where contacts are judged after each step, not during it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import irsim._core as core
from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Path
from irsim.scenario.checks._context import Context
from irsim.scenario.checks._outlines import segment_gap
from irsim.scenario.messages.findings import Finding, warning
from irsim.scenario.resolve.body_size import Point, SizedBody, SizedShape, has_fixed_shape
from irsim.scenario.resolve.resolved import ObjectRecord

_PASSABLE = ("unobstructed", "reactive")
"""Collision modes in which objects pass through each other anyway."""
_CONTINUOUS = ("contact",)
"""Collision modes in which nothing passes through a body, however fast it is."""
_MAX_LEGS = 1000
"""Largest number of legs of a path that is examined; an object with more legs is assumed to get anywhere."""
_TURNING_RADII = 2.0
"""Space that an object needs to turn towards its goal, in radii of its turning circle."""


def check(context: Context) -> Iterator[Finding]:
    """One finding per entry: an object can pass through another that is thinner than one step."""
    world = context.scenario.world
    if world.collision_mode in (*_PASSABLE, *_CONTINUOUS) or world.contacts == "swept":
        return
    dt, shapes = world.step_time, dict[int, SizedShape]()
    bodies = [
        SizedBody(record, shapes.setdefault(id(record.shape), SizedShape(record.shape)))
        for record in context.resolved.objects
        if has_fixed_shape(record.shape)
    ]
    there = [body for body in bodies if not body.record.unobstructed]  # an unobstructed body itself still collides
    fast = [
        body
        for body in bodies
        if body.record.kinematics is not None
        and not body.record.recorded
        and 0 < body.speed < math.inf
        and math.isfinite(body.shape.width)
        and body.speed * dt > body.shape.width
    ]
    if not fast:
        return
    thin_first = sorted(there, key=lambda b: (b.shape.width, b.record.id))
    random = {index for placement in context.resolved.placements for index in placement.objects}
    reported: set[Path] = set()
    for one in fast:
        own = 2 * one.shape.disc
        if one.record.path in reported or own == 0:  # a line may move along itself
            continue
        band = _band(context, one) if one.record.id not in random else None
        jump = None
        for other in thin_first:
            step = one.speed * dt if other.speed == 0 else (one.speed + other.speed) * dt
            if step <= own + other.shape.width and other.speed == 0:
                break  # all others are thicker or slower
            if other.record is one.record or step <= own + other.shape.width:
                continue
            if _may_meet(one, other, None if other.record.id in random else band, dt):
                jump = other, own + other.shape.width, step / dt
                break
        if jump is not None:
            reported.add(one.record.path)
            yield _finding(context, one, *jump)


def _finding(context: Context, one: SizedBody, other: SizedBody, least: float, speed: float) -> Finding:
    dt = context.scenario.world.step_time
    thing = other.record.called
    together = "" if other.speed == 0 else f", and {thing} {metres(other.speed * dt)} towards it"
    longest = math.floor(least / speed * 100) / 100 or float(f"{least / speed:.1g}")
    return warning(
        "jumps-through",
        context.entry_path(one.record, "vel_max") if context.is_given(one.record, "vel_max") else one.record.path,
        f"'{one.record.name}' moves {metres(one.speed * dt)} per step{together}: it can pass through {thing} "
        f"({metres(other.shape.width)} thick) without ever touching it",
        given=one.record.vel_max,
        fix=f"step_time: {min(longest, least / speed):.3g} or less, or a lower speed (limits are in m/s), or "
        "contacts: swept in 'world'",
    )


@dataclass(frozen=True)
class _Band:
    """Region that an object driven by ``dash`` can reach.

    Attributes:
        far: Largest distance of any point of its body from its straight path [m].
        parts: The region, world frame: along the path, and round goals that it may overshoot.
    """

    far: float
    parts: Sequence[Any]


def _may_meet(one: SizedBody, other: SizedBody, band: _Band | None, dt: float) -> bool:
    """Whether two objects can meet; always True if the path of either is not straight."""
    if other.speed > 0:
        if one.record.behavior is None or other.record.behavior is None:
            return False  # a program drives them and is responsible for that
        if not (_is_straight(one.record) and _is_straight(other.record)):
            return True
        return _are_near(one, other, one.shape.reach + other.shape.reach + (one.speed + other.speed) * dt)
    if band is None:
        return True
    return _are_near(one, other, band.far + other.shape.reach) and core.intersects(
        band.parts, (0.0, 0.0, 0.0), other.shape.parts, other.record.state[:3]
    )


def _are_near(one: SizedBody, other: SizedBody, gap: float) -> bool:
    """Whether two paths come within ``gap`` of each other; the path of a static object is one point."""
    others = other.legs if other.speed > 0 else [(other.legs[0][0], other.legs[0][0])]
    a, b = one.box, other.box if other.speed > 0 else (*others[0][0], *others[0][0])
    if a[0] - gap > b[2] or b[0] - gap > a[2] or a[1] - gap > b[3] or b[1] - gap > a[3]:
        return False
    return min(segment_gap(leg, other_leg) for leg in one.legs for other_leg in others) <= gap


def _band(context: Context, body: SizedBody) -> _Band | None:
    """The region that an object can reach; None if it may go anywhere."""
    world, record = context.scenario.world, body.record
    driven = record.group_behavior is not None or record.group in context.driven_groups
    if min(map(len, (record.vel_min, record.vel_max, record.acce))) < 2:  # another check reports them as too short
        return None
    if not _is_straight(record) or driven or world.control_mode != "auto":
        return None
    legs = body.legs
    if len(legs) > _MAX_LEGS:
        return None
    heading = record.state[2] if len(record.state) > 2 else 0.0
    off = 0.0
    for start, end in legs:
        off = max(off, _deviation(record, heading, start, end))
        heading = math.atan2(end[1] - start[1], end[0] - start[0])
    step = body.speed * world.step_time
    side = body.shape.reach + record.goal_threshold + off
    far = side
    if step > 2 * record.goal_threshold:  # it may overshoot the goal and turn back
        far += step + (_turning_space(record) if getattr(record.kinematics, "speeds", 0) == 1 else 0.0)
    if not math.isfinite(far):
        return None
    parts: list[Any] = [core.Circle(radius=side, center=list(legs[0][0]))]
    for (ax, ay), (bx, by) in legs:
        length = math.hypot(bx - ax, by - ay)
        parts.append(core.Circle(radius=far, center=[bx, by]))
        if length > 0:
            u, v = side * (bx - ax) / length, side * (by - ay) / length
            corners = [[ax + v, ay - u], [bx + v, by - u], [bx - v, by + u], [ax - v, ay + u]]
            parts.append(core.Polygon(vertices=corners))
    return _Band(far, parts)


def _deviation(record: ObjectRecord, heading: float, start: Point, end: Point) -> float:
    """Largest deviation of ``dash`` from a straight leg [m]; infinity if its path is not straight."""
    drive, length = record.kinematics, math.dist(start, end)
    if length == 0:
        return 0.0
    error = abs(math.remainder(math.atan2(end[1] - start[1], end[0] - start[0]) - heading, 2 * math.pi))
    speeds, tolerance = getattr(drive, "speeds", 0), getattr(record.behavior, "angle_tolerance", 0.0)
    if getattr(drive, "noise", False):
        return math.inf
    if speeds == 2:
        limits = {abs(speed) for speed in (*record.vel_min[:2], *record.vel_max[:2])}
        return 0.0 if len(limits) == 1 and record.acce[0] == record.acce[1] == math.inf else math.inf
    if speeds != 1:
        return math.inf
    if getattr(drive, "steered", False) and (error > tolerance or any(record.state[3:])):
        return math.inf
    if error <= tolerance:  # `dash` does not correct errors within its tolerance
        return length * math.sin(min(error, math.pi / 2))
    return _turning_space(record) + length * math.sin(min(tolerance, math.pi / 2))


def _turning_space(record: ObjectRecord) -> float:
    """Space that an object needs to turn at full speed [m]; infinity if unknown."""
    rate, drive = abs(record.vel_max[1]), record.kinematics
    if getattr(drive, "speeds", 0) != 1 or getattr(drive, "steered", True) or rate == 0 or record.acce[1] < math.inf:
        return math.inf
    return _TURNING_RADII * abs(record.vel_max[0]) / rate


def _is_straight(record: ObjectRecord) -> bool:
    return getattr(record.behavior, "name", "") == "dash" and not record.wander and bool(record.goals)
