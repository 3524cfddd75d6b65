"""Whether the time suffices, and whether a behavior that plans no way can find one."""

from __future__ import annotations

import math

import numpy as np

from irsim.episodes.episode import HORIZON_FACTOR, MIN_HORIZON
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Room
from irsim.validation.feasibility.local_minima import Trap, trap_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import Scene
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_EIGHT = math.cos(math.pi / 8)
"""The shortest way is at least so many times as long as one over eight neighbours."""
_MOST_WAYS = 3
"""Ways that are measured in one scene."""
_MOST_TRAPS = 8
"""Robots with something in their way whose way is looked at in one scene."""
_SHORT = 0.9
_DETOUR = 1.25
_LOCAL = ("rvo", "sfm", "orca")


def check(context: Context, scene: Scene, movers: list[Mover], legs: dict[int, list[Leg]], tally: Tally) -> None:
    """Robots that are not there in time, or stand before a wall."""
    going = [m for m in movers if m.record.id in legs and not m.record.wander and m.record.role == "robot"]
    straight = {m.record.id: _straight(legs[m.record.id]) for m in going}
    limit, whose = _horizon(context, going, straight)
    room = scene.owner.kept.get("room 0.0")
    measured = looked_at = 0
    for mover in sorted(going, key=lambda m: (-_time(m, straight[m.record.id]), m.record.id)):
        ways = legs[mover.record.id]
        length = straight[mover.record.id]
        blocked = [leg for leg in ways if leg.blocked]
        trap = None
        if blocked and mover.behavior in ("dash", *_LOCAL) and looked_at < _MOST_TRAPS:
            looked_at += 1
            trap = trap_of(scene, blocked[0])
            trap = None if trap is not None and trap.line and mover.behavior == "rvo" else trap  # it slips round lines
        if trap is not None and mover.behavior in _LOCAL:
            _stands(mover, blocked[0], trap, scene, tally)
        if blocked and mover.behavior == "dash":
            _dashes(mover, blocked[0], trap, scene, tally)
        elif blocked and isinstance(room, Room) and measured < _MOST_WAYS and not scene.rough:
            measured += 1
            around = sum(_length(room, leg) if leg.blocked else math.dist(leg.start, leg.goal) for leg in ways)
            if mover.behavior in _LOCAL and around > _DETOUR * length and trap is None:
                _detour(mover, blocked[0], scene, around, length, tally)
            length = max(length, around)
        if not mover.behavior or mover.record.loop or len(ways) < len(scene.goals[mover.record.id]):
            continue
        _late(mover, length, limit, whose, scene, tally)


def _straight(legs: list[Leg]) -> float:
    """Length of the straight lines, short of where it has arrived [m]."""
    return sum(max(0.0, math.dist(leg.start, leg.goal) - leg.mover.reach) for leg in legs)


def _time(mover: Mover, length: float) -> float:
    return length / mover.speed if mover.speed > 0 and math.isfinite(mover.speed) else 0.0


def _horizon(context: Context, going: list[Mover], straight: dict[int, float]) -> tuple[float, str]:
    limit = context.scenario.world.time_limit
    if limit is not None:
        return limit, f"time_limit is {limit:g} s"
    usual = max([MIN_HORIZON, *(HORIZON_FACTOR * _time(m, straight[m.record.id]) for m in going)])
    return usual, f"without a time_limit a run ends after {usual:.3g} s"


def _length(room: Room, leg: Leg) -> float:
    """No way is shorter [m]."""
    clearance = room.clearance
    goal = clearance.climb(leg.goal, leg.mover.reach + room.half)
    way = clearance.way(leg.start, goal, leg.mover.radius - room.half)
    if not len(way):
        return 0.0
    return _EIGHT * float(np.hypot(*np.diff(way, axis=0).T).sum()) - leg.mover.reach


def _late(mover: Mover, length: float, limit: float, whose: str, scene: Scene, tally: Tally) -> None:
    rate = _acceleration(mover)
    needed = _from_rest(mover, length, rate)
    if needed <= _SHORT * limit:
        return
    late = needed > limit
    slowly = f", speeding up by {rate:.3g} m/s²," if needed > 1.01 * _time(mover, length) else ""
    tally.add(
        "time-too-short",
        ("world", "time_limit") if whose.startswith("time_limit") else mover.path,
        mover.record,
        f"'{mover.record.name}' needs {needed:.3g} s or more for the {length:.3g} m to its goal "
        f"at {mover.speed:.3g} m/s{slowly}{'' if slowly else ','} and "
        + (whose if late else f"{whose}: that leaves nothing for turning and giving way"),
        f"time_limit: {math.ceil(2 * needed):g}, or {'a larger acce' if slowly else 'a faster robot'}",
        scene.seed,
        serious=late,
    )


def _acceleration(mover: Mover) -> float:
    """No speed changes faster [m/s²]; infinity where nothing limits it."""
    drive = getattr(mover.record.kinematics, "name", "")
    rates = mover.record.acce[: 2 if drive in ("omni", "omni_angular") else 1]
    return math.hypot(*rates) if rates and drive in ("diff", "acker", "omni", "omni_angular") else math.inf


def _from_rest(mover: Mover, length: float, rate: float) -> float:
    """No run over that length is shorter, from the speed at the start on [s]."""
    top, begin = mover.speed, math.hypot(*mover.record.velocity[:2])
    if not 0 < rate < math.inf or not begin < top < math.inf:
        return _time(mover, length)
    ramp = (top**2 - begin**2) / (2 * rate)
    if ramp >= length:
        return (math.sqrt(begin**2 + 2 * rate * length) - begin) / rate
    return (top - begin) / rate + (length - ramp) / top


def _stands(mover: Mover, leg: Leg, trap: Trap, scene: Scene, tally: Tally) -> None:
    x, y = trap.place
    tally.add(
        "needs-planning",
        mover.goal_path(leg.index),
        mover.record,
        f"'{mover.behavior}' avoids what is near and plans no way: before the wall in the way '{mover.record.name}' is "
        f"likely to stop near ({x:.2f}, {y:.2f}), from where the goal ({leg.goal[0]:g}, {leg.goal[1]:g}) lies straight "
        f"behind {trap.length:.3g} m of wall",
        f"behavior: {{name: follow, planner: astar, local: {mover.behavior}}}, or waypoints",
        scene.seed,
        serious=False,
    )


def _dashes(mover: Mover, leg: Leg, trap: Trap | None, scene: Scene, tally: Tally) -> None:
    name = mover.record.name
    tally.add(
        "dash-into-obstacle",
        mover.goal_path(leg.index),
        mover.record,
        f"'{name}' dashes straight to ({leg.goal[0]:g}, {leg.goal[1]:g}) and looks at nobody: an obstacle stands on "
        "that line",
        "behavior: {name: follow} plans a way round; "
        + (
            "rvo and orca get round single round things, and stay caught in dead ends"
            if trap is None
            else "rvo, sfm and orca stop before a flat wall"
        ),
        scene.seed,
        serious=False,
    )


def _detour(mover: Mover, leg: Leg, scene: Scene, around: float, length: float, tally: Tally) -> None:
    name = mover.record.name
    tally.add(
        "needs-planning",
        mover.goal_path(leg.index),
        mover.record,
        f"'{mover.behavior}' avoids what is near and plans no way: on the {around:.3g} m round the obstacles "
        f"(straight: {length:.3g} m) '{name}' is likely to get stuck",
        f"behavior: {{name: follow, planner: astar, local: {mover.behavior}}}, or waypoints",
        scene.seed,
        serious=False,
    )
