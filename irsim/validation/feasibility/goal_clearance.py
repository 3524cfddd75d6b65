"""Goals that lie in an obstacle, too near to one for the body, or outside the boundary walls."""

from __future__ import annotations

import math

import irsim._core as core
from irsim.common.text import metres
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Point, free_place, grid_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import StartState
from irsim.validation.feasibility.tally import Tally

__all__ = ["check"]

_RINGS = (0.5, 0.98)
"""Radii of the rings on which places around a goal are tried, as shares of the arrival distance."""
_PLACES_PER_RING = 16
_SLACK = 1e-3
"""Share by which the disc is smaller than the body, which may touch an obstacle."""


def check(context: Context, scene: StartState, movers: list[Mover], tally: Tally) -> set[tuple[int, int]]:
    """Report goals and waypoints that cannot be reached because of what stands there.

    Returns:
        Their (object id, index of the goal) pairs.
    """
    blocked: set[tuple[int, int]] = set()
    if not scene.things:
        return blocked
    known: dict[tuple[float, float, float, float], bool] = {}
    for mover in movers:
        if mover.record.wander:
            continue
        goals = scene.goals[mover.record.id]
        for index, goal in enumerate(goals):
            if _behind_walls(context, scene, mover, goal):
                blocked.add((mover.record.id, index))
                x0, y0, x1, y1 = scene.bounds
                tally.add_goal(
                    "goal-unreachable",
                    mover,
                    index,
                    f"'{mover.record.name}' cannot get to {_goal_term(goals, index)} ({goal[0]:g}, {goal[1]:g}): it "
                    "lies outside the walls around the world",
                    f"x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g}, a larger world, or no 'boundary: walls'",
                    serious=mover.record.role == "robot",
                )
                break
            key = (goal[0], goal[1], mover.radius, mover.reach)
            if key not in known:
                known[key] = fits_at(scene, mover, (goal[0], goal[1]))
            if known[key]:
                continue
            blocked.add((mover.record.id, index))
            what = _goal_term(goals, index)
            place = free_place(grid_of(scene, movers), (goal[0], goal[1]), mover.shape.around, _start(scene, mover))
            instead = "" if place is None else f": ({place[0]:.2f}, {place[1]:.2f}) is free"
            fix = f"a goal with {metres(mover.shape.around)} of free space around it{instead}"
            if scene.rough:  # a place that is free with one seed is not free with the next
                fix = (
                    "'range_low' and 'range_high' that keep randomly placed objects "
                    f"{metres(mover.shape.around)} away from the goal, or a goal outside that range"
                )
            tally.add_goal(
                "goal-blocked",
                mover,
                index,
                f"'{mover.record.name}' does not fit at {what} ({goal[0]:g}, {goal[1]:g}): "
                + _reason(context, scene, mover, goal),
                fix,
                serious=mover.record.role == "robot",
            )
            break
    return blocked


def _goal_term(goals: list[list[float]], index: int) -> str:
    return f"waypoint {index + 1}" if len(goals) > 1 else "the goal"


def _behind_walls(context: Context, scene: StartState, mover: Mover, goal: list[float]) -> bool:
    """Whether a goal lies outside walls that enclose the robot, too far for it to count as arrived at the wall."""
    if context.scenario.world.boundary != "walls":
        return False
    x0, y0, x1, y1 = scene.bounds
    x, y = _start(scene, mover)
    r = mover.radius
    off = math.hypot(max(x0 + r - goal[0], 0.0, goal[0] - x1 + r), max(y0 + r - goal[1], 0.0, goal[1] - y1 + r))
    outside = not (x0 <= goal[0] <= x1 and y0 <= goal[1] <= y1)
    return outside and x0 <= x <= x1 and y0 <= y <= y1 and off >= mover.reach


def fits_at(scene: StartState, mover: Mover, goal: Point) -> bool:
    """Whether the disc inside the body fits at a place that counts as arrived."""
    disc = [core.Circle(radius=mover.radius * (1 - _SLACK), center=[0, 0])]
    if not scene.terrain.collides(disc, (*goal, 0.0)):
        return True
    for share in _RINGS:
        for k in range(_PLACES_PER_RING):
            angle = 2 * math.pi * k / _PLACES_PER_RING
            x, y = (goal[i] + share * mover.reach * part for i, part in enumerate((math.cos(angle), math.sin(angle))))
            if not scene.terrain.collides(disc, (x, y, 0.0)):
                return True
    return False


def _start(scene: StartState, mover: Mover) -> Point:
    return mover.centre(scene.pose[mover.record.id])


def _reason(context: Context, scene: StartState, mover: Mover, goal: list[float]) -> str:
    point = [core.Circle(radius=0.0, center=[0, 0])]
    inside = scene.terrain.collides(point, (goal[0], goal[1], 0.0))
    name = _blocker(context, scene, mover, goal, 0.0 if inside else mover.radius)
    if inside:
        return f"it lies inside {name}"
    return f"{name} is closer than the {metres(mover.radius)} that the body needs"


def _blocker(context: Context, scene: StartState, mover: Mover, goal: list[float], radius: float) -> str:
    """Name of the obstacle within a radius of a goal."""
    disc = [core.Circle(radius=radius, center=[0, 0])]
    still = [r for r in context.resolved.objects if r.static and not r.unobstructed]
    for record, (parts, pose) in zip(still, scene.things, strict=False):
        if core.intersects(parts, pose, disc, (goal[0], goal[1], 0.0)):
            return record.called
    grid = context.resolved.grid
    return "an unknown part of the map" if grid is not None and grid.unknown else "an obstacle"
