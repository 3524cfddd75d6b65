"""Checks motion: objects that their behavior cannot move, goals that are never reached, roles without objects."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any

from irsim.common.text import metres
from irsim.components.options import CustomOptions
from irsim.diagnostics.diagnostic import Edit
from irsim.scenario.checks._context import Context, distinct
from irsim.scenario.checks.magnitude import MAX_MAGNITUDE
from irsim.scenario.messages.findings import Finding, hint, warning
from irsim.scenario.resolve.body_size import top_speed
from irsim.scenario.resolve.resolved import ObjectRecord
from irsim.scenario.yaml.formatting import flow

_PASSABLE = ("unobstructed", "reactive")
"""Collision modes in which objects pass through each other."""
_MAX_TURNS = 3
"""Full turns of a simulated car after which it counts as circling its goal."""
_MAX_STEPS = 5000
"""Steps of that simulation; longer ones are skipped."""


def check(context: Context) -> Iterator[Finding]:
    """Check all objects; one finding per path and code."""
    yield from distinct(_check_objects(context))


def _check_objects(context: Context) -> Iterator[Finding]:
    counts = {role: sum(r.role == role and not r.unobstructed for r in context.resolved.objects)
              for role in ("robot", "obstacle")}  # fmt: skip
    for record in context.entry_objects:
        if record.kinematics is None:
            continue
        yield from _cannot_move(context, record)
        yield from _no_targets(context, record, counts)
        if sum(counts.values()) > 0:
            yield from _unobstructed_robot(context, record)
        yield from _never_arrives(context, record)
        yield from _overshoot(context, record)
        yield from _circles_goal(context, record)


def _cannot_move(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    key = "behavior" if record.behavior is not None else "group_behavior"
    options: Any = getattr(record, key)
    if options is None or isinstance(options, CustomOptions):
        return
    path = context.entry_path(record, key) if context.is_given(record, key) else record.path
    if record.static:
        yield warning(
            "static-behavior",
            (*record.path, "static"),
            f"'{record.name}' is static: its behavior '{options.name}' never moves it",
            given=True,
            fix="remove 'static: true', or the behavior",
            edit=Edit("remove", (*record.path, "static")) if record.role == "robot" else None,
        )
        return
    drive: Any = record.kinematics
    rows: tuple[str, ...] = getattr(drive, "control_rows", ())
    if context.scenario.world.step_mode == "external" or drive.speeds == 0:
        return
    moving = drive.speeds
    ranges = list(zip(record.vel_min, record.vel_max, strict=False))
    if len(ranges) < moving or len(rows) != len(ranges) or any(low > high for low, high in ranges):
        return
    written = "vel_max" if context.is_given(record, "vel_max") else "vel_min"
    where = context.entry_path(record, written) if context.is_given(record, written) else path
    if all(low >= 0 >= high for low, high in ranges[:moving]):
        yield warning(
            "no-speed",
            where,
            f"the speed limits of '{record.name}' are zero, so its behavior '{options.name}' cannot move it",
            given=getattr(record, written),
            fix=f"vel_max: {flow([1.0] * len(ranges))}, in m/s and rad/s",
        )
    elif moving == 2 and not drive.turns and (lacking := _missing_direction(record)) is not None:
        row, sign, goal = lacking
        key = "vel_max" if sign > 0 else "vel_min"
        way = (("backwards", "forwards"), ("to the right", "to the left"))[row][sign > 0]
        yield warning(
            "no-speed",
            context.entry_path(record, key) if context.is_given(record, key) else where,
            f"'{record.name}' cannot turn or drive {way}, so it cannot reach ({goal[0]:g}, {goal[1]:g})",
            given=getattr(record, key),
            fix=f"use a {'positive' if sign > 0 else 'negative'} {('first', 'second')[row]} number in '{key}'",
        )
    elif moving == 1 and ranges[0][1] <= 0 and not record.wander:
        yield warning(
            "no-speed",
            where,
            f"'{record.name}' can only drive backwards (at most {ranges[0][1]:g} m/s), but '{options.name}' "
            "drives forwards",
            given=getattr(record, written),
            fix="use a positive first number in 'vel_max'",
        )
    elif moving == 1 and all(value == 0 for value in ranges[1]):
        what = "steer" if drive.steered else "turn"
        yield warning(
            "no-turning",
            where,
            f"the second limit is zero, so '{record.name}' cannot {what}: it only drives straight ahead",
            given=getattr(record, written),
            fix="use a second number greater than 0 in 'vel_max', and its negative in 'vel_min'",
        )
    begin = list(zip(record.acce, record.velocity, strict=False))[:moving]
    if len(begin) == moving and all(rate == 0 and speed == 0 for rate, speed in begin):
        yield warning(
            "no-speed",
            context.entry_path(record, "acce"),
            f"'acce' is zero, so '{record.name}' stays at rest",
            given=record.acce,
            fix="remove 'acce' for no limit, or give a rate in m/s²",
        )


def _missing_direction(record: ObjectRecord) -> tuple[int, int, list[float]] | None:
    """Row and sign of the speed that an object of fixed heading would need to reach a goal but lacks, and the goal."""
    if record.wander or getattr(record.kinematics, "noise", False):
        return None
    cos, sin = math.cos(record.state[2]), math.sin(record.state[2])
    for index, (a, b) in enumerate(itertools.pairwise([record.state, *record.goals])):
        x, y = b[0] - a[0], b[1] - a[1]
        slack = record.goal_threshold * (1 if index == 0 else 2)  # it may be this far from either end
        for row, part in enumerate((cos * x + sin * y, cos * y - sin * x)):
            if part > slack and record.vel_max[row] <= 0:
                return row, 1, b
            if part < -slack and record.vel_min[row] >= 0:
                return row, -1, b
    return None


def _never_arrives(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """A threshold of 0: an object arrives when its distance is below the threshold, so it never does."""
    behavior = record.behavior or record.group_behavior
    if record.goal_threshold > 0 or record.static or behavior is None:
        return
    yield warning(
        "goal-overshoot",
        (*record.path, "goal_threshold"),
        f"a goal counts as reached when it is nearer than 'goal_threshold', here 0 m: '{record.name}' never arrives",
        given=record.goal_threshold,
        fix="goal_threshold: 0.1, in metres",
    )


def _no_targets(context: Context, record: ObjectRecord, counts: dict[str, int]) -> Iterator[Finding]:
    """``target_roles`` that select no object, or that the behavior does not use."""
    for key in ("behavior", "group_behavior"):
        options: Any = getattr(record, key)
        roles = getattr(options, "target_roles", "all")
        if options is None or roles == "all" or isinstance(options, CustomOptions):
            continue
        where = (*context.entry_path(record, key), "target_roles")
        if not options.avoids:
            if "target_roles" in options.model_fields_set:
                message = f"'{options.name}' avoids no other object: 'target_roles' has no effect"
                yield hint("ignored-key", where, message, given=roles, fix="remove it")
            continue
        others = counts[roles] - (record.role == roles and not record.unobstructed)
        if others <= 0:
            other = "obstacle" if roles == "robot" else "robot"
            there = f"; the others are {other}s" if counts[other] - (record.role == other) > 0 else ""
            yield warning(
                "target-roles-nobody",
                where,
                f"there is no {'other ' if record.role == roles else ''}{roles} to avoid{there}",
                given=roles,
                allowed="all, robot, obstacle",
                fix="target_roles: all",
                edit=Edit("replace", where, "all"),
            )


def _unobstructed_robot(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Robots with ``unobstructed``, which is easily mistaken for permission to drive through obstacles."""
    if record.role != "robot" or not record.unobstructed or record.static:
        return
    if context.scenario.world.collision_mode in _PASSABLE:
        return
    yield hint(
        "unobstructed-robot",
        (*record.path, "unobstructed"),
        f"others pass through '{record.name}' and lidars do not see it, but it still collides with others itself",
        given=True,
        fix="to let it pass through obstacles, write 'unobstructed: true' on the obstacles; nothing to fix if others "
        "are meant to pass through it",
    )


def _overshoot(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Goals that a step can jump over again and again; cars, which cannot turn on the spot, shunt or circle there."""
    options: Any = record.active_behavior
    drive: Any = record.kinematics
    car, on_route = getattr(drive, "steered", False), getattr(options, "name", "") == "follow"
    options = getattr(options, "local", options)
    name = getattr(options, "name", "")
    drives = name == "dash" or getattr(options, "avoids", False)
    if not drives or record.static or not record.goals or record.goal_threshold <= 0:
        return
    dt = context.scenario.world.step_time
    step = top_speed(record) * dt
    if not (1 if car else 2) * record.goal_threshold * (1 + 1e-9) < step <= MAX_MAGNITUDE:
        return
    threshold = math.ceil(round(step * 100, 6)) / 100 if car else math.ceil(step / 2 * 100 + 1) / 100
    effect = "it may overshoot its goal"
    if car and not on_route:
        effect = "it may pass its goal between two steps and then circle it, as it cannot turn on the spot"
    elif car:
        backs = bool(record.vel_min) and record.vel_min[0] < 0
        effect = "it may shunt to and fro at its goal" if backs else "without reverse it may never get to its goal"
    report = warning if car else hint
    yield report(
        "goal-overshoot",
        record.path,
        f"'{record.name}' drives {metres(step)} per step under '{name}': {effect}; the goal counts as reached within "
        f"{record.goal_threshold:g} m",
        fix=f"goal_threshold: {threshold:g} or more, a smaller step_time, or a lower vel_max",
    )


def _circles_goal(context: Context, record: ObjectRecord) -> Iterator[Finding]:
    """Goals inside the turning circle of a car: ``dash`` steers towards them as far as it can and circles them."""
    drive: Any = record.kinematics
    options: Any = record.behavior if record.group_behavior is None else None
    if getattr(options, "name", "") != "dash" or drive.name != "acker" or drive.mode != "steer" or drive.noise:
        return
    pairs = min(len(record.vel_max), len(record.vel_min), len(record.acce))
    if record.static or record.wander or not record.goals or pairs < 2:
        return
    wheelbase, psi = record.wheelbase or 1.0, drive.psi_max or math.inf
    low, high = max(record.vel_min[1], -abs(record.vel_max[1]), -psi), min(record.vel_max[1], psi)
    speed, (x, y), goal = record.vel_max[0], record.state[:2], record.goals[0]
    if not -math.pi / 2 < low < 0 < high < math.pi / 2 or not 0 < speed < math.inf or record.acce[1] < math.inf:
        return
    radius = wheelbase / math.tan(min(high, -low))
    if math.dist((x, y), goal[:2]) > 2 * radius:
        return
    world = context.scenario.world
    least, step, exact = math.inf, speed * world.step_time, world.integration == "exact"
    if _MAX_TURNS * 2 * math.pi * radius > _MAX_STEPS * step:
        return
    steps = math.ceil(_MAX_TURNS * 2 * math.pi * radius / step)
    theta, steering = record.state[2], record.state[3] if len(record.state) > 3 else 0.0
    for _ in range(steps):
        least = min(least, math.dist((x, y), goal[:2]))
        if least < record.goal_threshold:
            return
        error = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - theta, 2 * math.pi)
        turn = step * math.tan(steering) / wheelbase
        half, chord = (turn / 2, step * math.sin(turn / 2) / (turn / 2)) if exact and turn else (0.0, step)
        x, y = x + chord * math.cos(theta + half), y + chord * math.sin(theta + half)
        theta += turn
        steering = min(max(error, low), high)
    towards = math.atan2(goal[1] - record.state[1], goal[0] - record.state[0])
    yield warning(
        "turning-circle",
        context.entry_path(record, "state") if context.is_given(record, "state") else record.path,
        f"the smallest turning radius of '{record.name}' is {metres(radius)}, and its goal ({goal[0]:g}, {goal[1]:g}) "
        f"lies inside that circle: it circles the goal and comes no nearer than {metres(least)}",
        fix=f"start towards the goal, with heading {towards:.4g}, or goal_threshold: "
        f"{math.ceil(least * 100 + 1) / 100:g}, or more steering in 'vel_max' and 'vel_min'",
    )
