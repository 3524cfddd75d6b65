"""Whether robots can arrive within the time limit, and whether a behavior without path planning can get there."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from irsim.common.text import metres
from irsim.diagnostics.diagnostic import Path
from irsim.episodes.obstructions import REACTIVE
from irsim.scenario.checks import Context
from irsim.scenario.resolve.body_size import reach_of
from irsim.scenario.resolve.braking import follow_text
from irsim.simulation.time_limit import HORIZON_FACTOR, MIN_HORIZON
from irsim.validation.feasibility.clearance_grid import ClearanceGrid
from irsim.validation.feasibility.dead_ends import Trap, first_pocket, trap_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.reachability import Leg
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_EIGHT_NEIGHBOUR_BOUND = math.cos(math.pi / 8)
"""Least ratio of the shortest path to the shortest one over cells with eight neighbours."""
_MAX_MEASURED_ROUTES = 3
"""Number of robots in one scene whose path around obstacles is measured."""
_MAX_TRAPS = 8
"""Number of robots in one scene that are checked for flat walls across their line."""
_TIGHT_TIME_SHARE = 0.9
"""Share of the time limit above which a route leaves no time for turning and giving way."""
_MIN_DETOUR = 1.25
"""Ratio of path to straight line from which on a behavior without path planning is likely to get stuck."""
_CREEP_SPEED = 0.15
"""Speed [m/s] below which a car under `orca` hardly gets to its goal: `orca` drives towards a wall at most at the room
before it divided by `timeHorizonObst`. Measured with 120 cars in a hall."""
_MARGIN_SHARE = 0.1
"""Margin of `avocado` without a `safe_radius`, as a share of the radius."""


@dataclass(frozen=True)
class _Need:
    """The time that a robot needs at least.

    Attributes:
        mover: The robot.
        length: Length of its path [m].
        moving: Time that it moves [s].
        rate: Its greatest acceleration [m/s²] if that costs time, else None.
    """

    mover: Mover
    length: float
    moving: float
    rate: float | None

    @property
    def total(self) -> float:
        """Time from the start of the run [s]."""
        return self.moving + self.mover.record.moves_from

    @property
    def ample(self) -> int:
        """A time limit that leaves as much time again for turning and giving way [s]."""
        return math.ceil(max(self.total + self.moving, self.total / _TIGHT_TIME_SHARE))


def check(context: Context, scene: StartState, movers: list[Mover], legs: dict[int, list[Leg]], tally: Tally) -> None:
    """Report robots that cannot arrive in time, or that their behavior leads to a wall."""
    going = [m for m in movers if m.record.id in legs and not m.record.wander and m.record.role == "robot"]
    straight = {m.record.id: _straight(legs[m.record.id]) for m in going}
    limit, limit_reason = _time_limit(context, going, straight)
    grid = scene.owner.kept.get("grid 0.0")
    measured = looked_at = 0
    needs: list[_Need] = []
    for mover in sorted(going, key=lambda m: (-_time(m, straight[m.record.id]), m.record.id)):
        route = legs[mover.record.id]
        length = straight[mover.record.id]
        blocked = [leg for leg in route if leg.blocked]
        trap = None
        if blocked and mover.behavior in ("dash", *REACTIVE) and looked_at < _MAX_TRAPS:
            looked_at += 1
            trap = trap_of(scene, blocked[0])
        if trap is None and mover.behavior in REACTIVE and (pocket := first_pocket(scene, route)) is not None:
            leg, trap = pocket
            _report_trap(mover, leg, trap, tally)
        elif trap is not None and mover.behavior in REACTIVE:
            _report_trap(mover, blocked[0], trap, tally)
        elif mover.behavior in REACTIVE and getattr(mover.record.kinematics, "steered", False):
            _check_car(mover, route, grid if isinstance(grid, ClearanceGrid) else None, tally)
        if blocked and mover.behavior == "dash":
            _report_dash(mover, blocked[0], trap, tally)
        elif blocked and isinstance(grid, ClearanceGrid) and measured < _MAX_MEASURED_ROUTES and not scene.rough:
            measured += 1
            around = sum(_path_length(grid, leg) if leg.blocked else math.dist(leg.start, leg.goal) for leg in route)
            if mover.behavior in REACTIVE and around > _MIN_DETOUR * length and trap is None:
                _report_detour(mover, blocked[0], around, length, tally)
            length = max(length, around)
        if not mover.behavior or mover.record.loop or len(route) < len(scene.goals[mover.record.id]):
            continue
        needs.append(_need(mover, length))
    _report_time(needs, limit, limit_reason, tally)


def _straight(legs: list[Leg]) -> float:
    """Length [m] of the straight lines from goal to goal, each up to where the robot counts as arrived."""
    return sum(max(0.0, math.dist(leg.start, leg.goal) - leg.mover.reach) for leg in legs)


def _time(mover: Mover, length: float) -> float:
    return length / mover.speed if mover.speed > 0 and math.isfinite(mover.speed) else 0.0


def _time_limit(context: Context, going: list[Mover], straight: dict[int, float]) -> tuple[float, str]:
    """Time limit of a run [s], and the reason for it in words."""
    limit = context.scenario.world.time_limit
    if limit is not None:
        return limit, f"time_limit is {limit:g} s"
    usual = max([MIN_HORIZON, *(HORIZON_FACTOR * _time(m, straight[m.record.id]) for m in going)])
    usual += max((m.record.moves_from for m in going), default=0.0)
    return usual, f"without a time_limit a run ends after {usual:.3g} s"


def _path_length(grid: ClearanceGrid, leg: Leg) -> float:
    """Lower bound of the length of a path around the obstacles of a leg [m]."""
    clearance = grid.clearance
    goal = clearance.climb(leg.goal, leg.mover.reach + grid.half)
    way = clearance.way(leg.start, goal, leg.mover.radius - grid.half)
    if not len(way):
        return 0.0
    return _EIGHT_NEIGHBOUR_BOUND * float(np.hypot(*np.diff(way, axis=0).T).sum()) - leg.mover.reach


def _need(mover: Mover, length: float) -> _Need:
    rate = _max_acceleration(mover)
    moving = _least_time(mover, length, rate)
    return _Need(mover, length, moving, rate if moving > 1.01 * _time(mover, length) else None)


def _report_time(needs: list[_Need], limit: float, limit_reason: str, tally: Tally) -> None:
    """Report robots that need more time than the limit, or nearly as much; one finding if the limit is written."""
    short = [need for need in needs if need.total > _TIGHT_TIME_SHARE * limit]
    short.sort(key=lambda need: (-need.total, need.mover.record.id))
    enough = max((need.ample for need in short), default=0)
    if limit_reason.startswith("time_limit"):
        others = sum(need.total > limit for need in short) - 1
        more = f"; {others} more robot{'s need' if others > 1 else ' needs'} more than that" if others > 0 else ""
        for need in short[:1]:
            _add_short(need, ("world", "time_limit"), limit, limit_reason + more, enough, tally)
        return
    for need in short:
        _add_short(need, need.mover.path, limit, limit_reason, enough, tally)


def _add_short(need: _Need, path: Path, limit: float, limit_reason: str, enough: float, tally: Tally) -> None:
    late = need.total > limit
    record, rate = need.mover.record, need.rate
    key = "appear_time" if record.appear_time > record.start_time else "start_time"
    wait = f" after its {key} of {record.moves_from:g} s" if record.moves_from else ""
    slowly = "," if rate is None else f", accelerating with {rate:.3g} m/s²,"
    tally.add(
        "time-too-short",
        path,
        record,
        f"'{record.name}' needs at least {need.total:.3g} s for the {metres(need.length)} to its goal "
        f"at {need.mover.speed:.3g} m/s{wait}{slowly} and "
        + (limit_reason if late else f"{limit_reason}, which leaves no time for turning and giving way"),
        f"time_limit: {enough:g}, or {'a faster robot' if rate is None else 'a larger acce'}",
        serious=late,
        entry=path if path[0] == "world" else None,
    )


def _max_acceleration(mover: Mover) -> float:
    """Greatest acceleration [m/s²]; infinity if it is not limited."""
    rates = mover.record.acce[: getattr(mover.record.kinematics, "speeds", 0)]
    return math.hypot(*rates) if rates else math.inf


def _least_time(mover: Mover, length: float, rate: float) -> float:
    """Lower bound of the time [s] to travel a length [m], from the initial speed and with an acceleration [m/s²]."""
    top, begin = mover.speed, math.hypot(*mover.record.velocity[:2])
    if not 0 < rate < math.inf or not begin < top < math.inf:
        return _time(mover, length)
    ramp = (top**2 - begin**2) / (2 * rate)
    if ramp >= length:
        return (math.sqrt(begin**2 + 2 * rate * length) - begin) / rate
    return (top - begin) / rate + (length - ramp) / top


def _report_trap(mover: Mover, leg: Leg, trap: Trap, tally: Tally) -> None:
    x, y = trap.place
    where = (
        f"in front of a wall {metres(trap.length)} long"
        if trap.gap is None
        else f"in front of two circles {metres(trap.gap)} apart, too near for it to pass between them"
    )
    tally.add_goal(
        "needs-planning",
        mover,
        leg.index,
        f"'{mover.behavior}' avoids nearby objects but plans no path: '{mover.record.name}' is likely to stop near "
        f"({x:.2f}, {y:.2f}), {where}, behind which its goal ({leg.goal[0]:g}, {leg.goal[1]:g}) lies",
        f"behavior: {{name: follow, planner: astar, local: {mover.behavior}}}, or waypoints",
        serious=False,
    )


def _check_car(mover: Mover, route: list[Leg], grid: ClearanceGrid | None, tally: Tally) -> None:
    """Report a car that has no planner and has to drive around something static, or to a goal close to it."""
    name = mover.record.name
    why = f"'{mover.behavior}' alone plans no path for the car '{name}', which cannot turn on the spot: "
    blocked = next((leg for leg in route if leg.blocked), None)
    if blocked is not None:
        leg, why = blocked, why + "it may stop before the obstacle on the straight line to "
    else:
        near = next((leg for leg in route if grid is not None and _creeps(mover, leg, grid)), None)
        if near is None:
            return
        leg, why = near, why + "it gets slower and slower near the obstacle at "
    tally.add_goal(
        "needs-planning",
        mover,
        leg.index,
        f"{why}({leg.goal[0]:g}, {leg.goal[1]:g})",
        follow_text(mover.record),
        serious=False,
    )


def _creeps(mover: Mover, leg: Leg, grid: ClearanceGrid) -> bool:
    """Whether the circle around a car under ``orca`` or ``avocado`` has so little room at a goal that it creeps."""
    record = mover.record
    options: Any = record.active_behavior
    if mover.behavior not in ("orca", "avocado") or not grid.holds(leg.goal):
        return False
    reach = reach_of(record.shape)
    margin = _MARGIN_SHARE * reach if options.safe_radius is None else options.safe_radius
    room = float(grid.at(np.array([leg.goal]))[0]) - reach - margin
    return bool(room + record.goal_threshold < _CREEP_SPEED * options.timeHorizonObst)


def _report_dash(mover: Mover, leg: Leg, trap: Trap | None, tally: Tally) -> None:
    name = mover.record.name
    tally.add_goal(
        "dash-into-obstacle",
        mover,
        leg.index,
        f"'{name}' dashes straight to ({leg.goal[0]:g}, {leg.goal[1]:g}) without avoiding anything: an obstacle stands "
        "on that line",
        "behavior: {name: follow} plans a path around it; "
        + (
            "rvo, sfm and orca get around single obstacles but stay caught in dead ends"
            if trap is None
            else "rvo, sfm and orca stay caught in this dead end"
        ),
        serious=False,
    )


def _report_detour(mover: Mover, leg: Leg, around: float, length: float, tally: Tally) -> None:
    name = mover.record.name
    tally.add_goal(
        "needs-planning",
        mover,
        leg.index,
        f"'{mover.behavior}' avoids nearby objects but plans no path: '{name}' is likely to get stuck on the "
        f"path of {metres(around)} around the obstacles (straight line: {metres(length)})",
        f"behavior: {{name: follow, planner: astar, local: {mover.behavior}}}, or waypoints",
        serious=False,
    )
