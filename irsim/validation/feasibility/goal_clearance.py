"""Goals where the body has no room."""

from __future__ import annotations

import math

import irsim._core as core
from irsim.scenario.checks import Context
from irsim.validation.feasibility.clearance_grid import Point, free_place, room_of
from irsim.validation.feasibility.movers import Mover
from irsim.validation.feasibility.scenes import Scene
from irsim.validation.feasibility.tally import Tally

__all__ = ["check", "has_room"]

_RINGS, _PER_RING = (0.5, 0.98), 16
_SLACK = 1e-3


def check(context: Context, scene: Scene, movers: list[Mover], tally: Tally) -> set[tuple[int, int]]:
    """Goals and waypoints in obstacles, in the map, or too near to them: ids and indices."""
    found: set[tuple[int, int]] = set()
    if not scene.things:
        return found
    known: dict[tuple[float, float, float, float], bool] = {}
    for mover in movers:
        if mover.record.wander:
            continue
        goals = scene.goals[mover.record.id]
        for index, goal in enumerate(goals):
            if _behind_walls(context, scene, mover, goal):
                found.add((mover.record.id, index))
                x0, y0, x1, y1 = scene.bounds
                tally.add(
                    "goal-unreachable",
                    mover.goal_path(index),
                    mover.record,
                    f"'{mover.record.name}' cannot get to {_what(goals, index)} ({goal[0]:g}, {goal[1]:g}): it lies "
                    "outside of the walls round the world",
                    f"x from {x0:g} to {x1:g} and y from {y0:g} to {y1:g}, a larger world, or no 'boundary: walls'",
                    scene.seed,
                    serious=mover.record.role == "robot",
                )
                break
            key = (goal[0], goal[1], mover.radius, mover.reach)
            if key not in known:
                known[key] = has_room(scene, mover, (goal[0], goal[1]))
            if known[key]:
                continue
            found.add((mover.record.id, index))
            what = _what(goals, index)
            place = free_place(room_of(scene, movers), (goal[0], goal[1]), mover.around, _start(scene, mover))
            instead = "" if place is None else f": ({place[0]:.2f}, {place[1]:.2f}) is free"
            fix = f"a goal with {mover.around:.3g} m of free space around it{instead}"
            if scene.rough:  # what is free under one seed is not under the next
                fix = (
                    f"'range_low' and 'range_high' of what is placed at random that keep {mover.around:.3g} m off the "
                    "goal, or a goal outside of them"
                )
            tally.add(
                "goal-blocked",
                mover.goal_path(index),
                mover.record,
                f"'{mover.record.name}' has no room at {what} ({goal[0]:g}, {goal[1]:g}): "
                + _why(context, scene, mover, goal),
                fix,
                scene.seed,
                serious=mover.record.role == "robot",
            )
            break
    return found


def _what(goals: list[list[float]], index: int) -> str:
    return f"waypoint {index + 1}" if len(goals) > 1 else "the goal"


def _behind_walls(context: Context, scene: Scene, mover: Mover, goal: list[float]) -> bool:
    """Whether a goal is outside of walls that the robot is inside of, farther than it has to get near."""
    if context.scenario.world.boundary != "walls":
        return False
    x0, y0, x1, y1 = scene.bounds
    x, y = _start(scene, mover)
    r = mover.radius
    off = math.hypot(max(x0 + r - goal[0], 0.0, goal[0] - x1 + r), max(y0 + r - goal[1], 0.0, goal[1] - y1 + r))
    outside = not (x0 <= goal[0] <= x1 and y0 <= goal[1] <= y1)
    return outside and x0 <= x <= x1 and y0 <= y <= y1 and off >= mover.reach


def has_room(scene: Scene, mover: Mover, goal: Point) -> bool:
    """Whether the disc inside of the body can be where it counts as arrived."""
    disc = [core.Circle(radius=mover.radius * (1 - _SLACK), center=[0, 0])]
    if not scene.terrain.collides(disc, (*goal, 0.0)):
        return True
    for share in _RINGS:
        for k in range(_PER_RING):
            angle = 2 * math.pi * k / _PER_RING
            x, y = (goal[i] + share * mover.reach * part for i, part in enumerate((math.cos(angle), math.sin(angle))))
            if not scene.terrain.collides(disc, (x, y, 0.0)):
                return True
    return False


def _start(scene: Scene, mover: Mover) -> Point:
    return mover.centre(scene.pose[mover.record.id])


def _why(context: Context, scene: Scene, mover: Mover, goal: list[float]) -> str:
    point = [core.Circle(radius=0.0, center=[0, 0])]
    inside = scene.terrain.collides(point, (goal[0], goal[1], 0.0))
    name = _blocker(context, scene, mover, goal, 0.0 if inside else mover.radius)
    if inside:
        return f"it lies inside of {name}"
    return f"{name} is nearer than the {mover.radius:.3g} m that the body needs"


def _blocker(context: Context, scene: Scene, mover: Mover, goal: list[float], radius: float) -> str:
    """Name of the thing that is there."""
    disc = [core.Circle(radius=radius, center=[0, 0])]
    still = [r for r in context.resolved.objects if r.static and not r.unobstructed]
    for record, (parts, pose) in zip(still, scene.things, strict=False):
        if core.intersects(parts, pose, disc, (goal[0], goal[1], 0.0)):
            kinds = {"map": "the map", "walls": "the wall round the world"}
            return kinds.get(record.shape.name, f"'{record.name}'")
    return "an obstacle"
