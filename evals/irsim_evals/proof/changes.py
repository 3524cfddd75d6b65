"""Which facts differ between two worlds: what decides whether a mutant must be noticed or accepted."""

from __future__ import annotations

import math
from typing import Any

import shapely

from irsim_evals.cases.model import Case, Pin
from irsim_evals.grader.body import Body
from irsim_evals.grader.scene import Scene
from irsim_evals.grader.selection import select

__all__ = ["FACTS", "WORLD_FACTS", "changed_facts", "touches"]

FACTS = (
    "count", "role", "kinematics", "shape", "size", "position", "heading", "goal", "goal_heading", "behavior",
    "options", "limits", "sensors", "color", "name", "threshold", "passable", "wheelbase", "fov", "tags",
)  # fmt: skip
"""Kinds of facts of a body."""
WORLD_FACTS = ("size", "origin", "times", "modes", "map", "fog")
"""Kinds of facts of the world."""
_SAME = 1e-6
"""Difference of two numbers that counts as none."""


def changed_facts(before: Scene, after: Scene) -> set[tuple[str, str]]:
    """(name of a body of the first world, kind of fact) pairs that differ; ``world`` stands for the world itself.

    Bodies are matched by their place in the file. A body without a counterpart has changed its ``count``; one that is
    only in the second world is named ``+``.
    """
    found = {("world", kind) for kind in WORLD_FACTS if not _alike(_of_world(before, kind), _of_world(after, kind))}
    pairs = _matched(before.bodies, after.bodies)
    for body, other in pairs:
        if body is None:
            found.add(("+", "count"))
        elif other is None:
            found.add((body.name, "count"))
        else:
            found |= {
                (body.name, kind) for kind in FACTS[1:] if not _alike(_of_body(body, kind), _of_body(other, kind))
            }
    return found


def touches(case: Case, scene: Scene, changed: set[tuple[str, str]], pins: list[Pin]) -> set[tuple[str, str]]:
    """The changes that one of the pins names."""
    selectors = dict(case.select)
    found: set[tuple[str, str]] = set()
    for pin in pins:
        kinds = set(pin.facts)
        if pin.of == "world":
            found |= {(name, kind) for name, kind in changed if name == "world" and kind in kinds}
            continue
        names = {body.name for body in select(scene, pin.of, selectors)}
        if "pose" in kinds:
            kinds |= {"position", "heading"}
        found |= {(name, kind) for name, kind in changed if kind in kinds and (name in names or name == "+")}
    return found


def _matched(first: list[Body], second: list[Body]) -> list[tuple[Body | None, Body | None]]:
    """Bodies in pairs: by name if names agree, else by place."""
    if len(first) == len(second):
        return list(zip(first, second, strict=True))
    left = list(second)
    pairs: list[tuple[Body | None, Body | None]] = []
    for body in first:
        same = [other for other in left if other.name == body.name and other.role == body.role]
        near = sorted(left, key=lambda other: (other.role != body.role, math.dist(other.position, body.position)))
        likely = same or [other for other in near[:1] if other.role == body.role]
        match = likely[0] if likely else None
        if match is not None:
            left.remove(match)
        pairs.append((body, match))
    return [*pairs, *((None, other) for other in left)]


def _of_world(scene: Scene, kind: str) -> Any:
    world = scene.world
    if kind == "size":
        return [world.width, world.height]
    if kind == "origin":
        return list(scene.bounds[:2])
    if kind == "times":
        return [world.step_time, world.sample_time, world.time_limit]
    if kind == "modes":
        return [world.control_mode, world.collision_mode, world.step_mode, world.boundary]
    if kind == "fog":
        return [world.fog_map, world.fog_map_resolution]
    options = world.obstacle_map
    return None if options is None else str(options)


def _of_body(body: Body, kind: str) -> Any:
    if kind == "size":
        return [body.radius] if body.radius is not None else sorted(body.extent)
    if kind == "position":
        return list(body.position)
    if kind == "heading":
        return [math.cos(body.pose[2]), math.sin(body.pose[2])] if not body.static or body.role == "robot" else None
    if kind == "goal":
        return [goal[:2] for goal in body.goals]
    if kind == "goal_heading":
        return [goal[2:3] for goal in body.goals]
    if kind == "shape":
        return [body.shape, round(float(shapely.area(body.footprint)) > 0)]
    if kind == "behavior":
        return [body.behavior, body.wander, body.loop]
    if kind == "options":
        return body.options
    if kind == "passable":
        return body.passable
    if kind == "fov":
        return [body.fov, body.fov_radius]
    if kind == "tags":
        return list(body.tags)
    return getattr(body, kind)


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(_alike(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, (int, float)) and isinstance(b, (int, float)) and not isinstance(a, bool):
        return a == b or abs(a - b) <= _SAME
    return bool(a == b)
