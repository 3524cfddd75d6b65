"""Cars without reverse under ``follow`` whose goals lie inside their turning circle, or that miss them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from irsim.common.text import metres
from irsim.episodes.obstructions import lacks_reverse, needs_reverse, reverse_fix, turning_radius
from irsim.scenario.checks import Context
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_MAX_CARS = 20
"""Number of cars in one scene that are simulated."""
_MAX_STEPS = 2000
"""Steps of one simulation, which ends earlier as soon as the car drives straight to its goal."""
_STRAIGHT = 0.01
"""Angle [rad] between heading and goal, and of the wheels, below which a car drives straight to its goal."""

Pose = tuple[float, float, float]


def check(context: Context, scene: StartState, movers: list[Mover], legs: dict[int, list[Leg]], tally: Tally) -> None:
    """Report cars that would have to back up on a free straight line to a goal, but cannot."""
    cars = [m for m in movers if lacks_reverse(m.record) and legs.get(m.record.id) and not m.record.wander]
    for mover in cars[:_MAX_CARS]:
        options: Any = mover.record.active_behavior
        if options.within or options.avoid:
            continue  # its path may have corners where nothing stands
        x, y, theta = scene.pose[mover.record.id][:3]
        pose: Pose | None = (x, y, theta)
        for leg in legs[mover.record.id]:
            if leg.blocked or pose is None:
                break
            if needs_reverse(mover.record, pose, leg.goal):
                _report(mover, leg, tally, missed=None)
                break
            pose, missed = _drive(mover, pose, leg.goal, context.scenario.world.step_time)
            if missed is not None:
                _report(mover, leg, tally, missed=missed)
                break


def _drive(mover: Mover, pose: Pose, goal: Sequence[float], step_time: float) -> tuple[Pose | None, float | None]:
    """Drive as ``follow`` with the local behavior ``dash`` does.

    Returns:
        The pose on arrival, None if it is not known; and the distance [m] at which the car needs reverse, or None.
    """
    record = mover.record
    options: Any = record.active_behavior
    drive: Any = record.kinematics
    local = getattr(options.local, "name", options.local)
    if local != "dash" or drive.mode != "steer" or drive.noise:
        return None, None
    most = math.atan((record.wheelbase or 0.0) / turning_radius(record))
    wheels = record.state[3] if len(record.state) > 3 else 0.0
    x, y, theta = pose
    control = [float(v) for v in record.velocity[:2]] or [0.0, 0.0]
    for _ in range(_MAX_STEPS):
        error = math.remainder(math.atan2(goal[1] - y, goal[0] - x) - theta, 2 * math.pi)
        left = math.dist((x, y), goal[:2])
        if left < record.goal_threshold:
            return (x, y, theta), None
        if abs(error) < _STRAIGHT and abs(wheels) < _STRAIGHT:
            on = left - record.goal_threshold
            return (x + on * math.cos(theta), y + on * math.sin(theta), theta), None
        if needs_reverse(record, (x, y, theta), goal):
            return None, left
        for k, wanted in enumerate((record.vel_max[0], min(max(error, -most), most))):
            change = record.acce[k] * step_time
            low, high = max(record.vel_min[k], control[k] - change), min(record.vel_max[k], control[k] + change)
            control[k] = min(max(wanted, low), high)
        way = control[0] * step_time
        x, y = x + way * math.cos(theta), y + way * math.sin(theta)
        theta += way * math.tan(wheels) / (record.wheelbase or 1.0)
        wheels = control[1]
    return None, None


def _report(mover: Mover, leg: Leg, tally: Tally, *, missed: float | None) -> None:
    record = mover.record
    goal = f"({leg.goal[0]:g}, {leg.goal[1]:g})"
    why = (
        f"{goal} lies inside its turning circle of radius {metres(turning_radius(record))}, so it stands still"
        if missed is None
        else f"it gets within {metres(missed)} of {goal} and then stands still, as the goal lies inside its turning "
        f"circle of radius {metres(turning_radius(record))} by then"
    )
    tally.add_goal(
        "turning-circle",
        mover,
        leg.index,
        f"'{record.name}' needs reverse, which 'vel_min' rules out: {why}",
        f"{reverse_fix(record)} lets it back up, or a goal farther ahead, or more steering in 'vel_max' and 'vel_min'",
    )
