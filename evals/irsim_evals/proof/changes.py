"""Which facts differ between two worlds: what decides whether a mutant must be noticed or accepted."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import shapely

from irsim_evals.cases.model import FACTS, GROUPS, WORLD_FACTS, Case, Pin
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.scene import GradedScene
from irsim_evals.grader.selection import select

__all__ = ["all_free", "changed_facts", "touches"]

_DERIVED = ("way", "cover")
"""Kinds of facts that change only together with others, such as the position or the size: a case that leaves those
free leaves these free."""
_SAME = 1e-6
"""Difference of two numbers that counts as none."""
_FULL_TURN = 6.2
"""Opening angle [rad] of a sensor from which on it sees all round."""
_OF_SENSORS = {"sensor_kind": "name", "range": "range_max", "beams": "number", "opening": "angle_range"}
"""Kind of fact of a sensor → its option."""


def changed_facts(before: GradedScene, after: GradedScene) -> set[tuple[str, str]]:
    """(name of a body of the first world, kind of fact) pairs that differ; ``world`` stands for the world itself.

    A body without a counterpart has changed its ``count``; one that is only in the second world has a ``+`` before its
    name.
    """
    worlds = _facts_of_world(before), _facts_of_world(after)
    differences = {("world", kind) for kind in WORLD_FACTS if not _alike(worlds[0][kind], worlds[1][kind])}
    pairs = _matched(before.bodies, after.bodies)
    drawn, drawn_after = _drawn(before), _drawn(after)
    for body, other in pairs:
        if body is None:
            differences.add((f"+{other.name}" if other is not None else "+", "count"))
        elif other is None:
            differences |= {(body.name, "count"), (body.name, "cover")}
        else:
            if body.static and not other.footprint.buffer(_SAME).covers(body.footprint):
                differences.add((body.name, "cover"))
            if (body.index in drawn) != (other.index in drawn_after):
                differences.add((body.name, "random"))
            own, others = _facts_of_body(body), _facts_of_body(other)
            differences |= {(body.name, kind) for kind in FACTS[1:-2] if not _alike(own[kind], others[kind])}
    return differences


def _drawn(scene: GradedScene) -> set[int]:
    """Rows of the bodies whose places are drawn anew with each seed."""
    return {row for placement in scene.env.scenario.placements for row in placement.objects}


def touches(
    case: Case, scenes: tuple[GradedScene, GradedScene], changed: set[tuple[str, str]], pins: list[Pin]
) -> set[tuple[str, str]]:
    """The changes that one of the pins names.

    Args:
        case: The case.
        scenes: The first world and the second one.
        changed: Differences, as :func:`changed_facts` says them.
        pins: Pinned or free facts.
    """
    selectors = dict(case.select)
    touched: set[tuple[str, str]] = set()
    for pin in pins:
        kinds = {kind for fact in pin.facts for kind in GROUPS.get(fact, (fact,))}
        if pin.of in ("reply", "text"):
            continue
        if pin.of == "world":
            touched |= {(name, kind) for name, kind in changed if name == "world" and kind in kinds}
            continue
        names = {body.name for body in select(scenes[0], pin.of, selectors)}
        names |= {f"+{body.name}" for body in select(scenes[1], pin.of, selectors)}
        touched |= {(name, kind) for name, kind in changed if kind in kinds and name in names}
    return touched


def all_free(case: Case, scenes: tuple[GradedScene, GradedScene], changed: set[tuple[str, str]]) -> bool:
    """Whether a case leaves every change free; arguments as for :func:`touches`."""
    plain = {(name, kind) for name, kind in changed if kind not in _DERIVED}
    return plain == touches(case, scenes, plain, case.free)


def _matched(first: list[GradedBody], second: list[GradedBody]) -> list[tuple[GradedBody | None, GradedBody | None]]:
    """Bodies in pairs: in the order of the files if that fits, else by place and name, the surest pairs first."""
    if len(first) == len(second) and all(a.role == b.role for a, b in zip(first, second, strict=True)):
        return list(zip(first, second, strict=True))
    right, pairs = list(second), dict[int, GradedBody]()
    tests: list[Callable[[GradedBody, GradedBody], bool]] = [
        lambda a, b: a.name == b.name and math.dist(a.position, b.position) <= _SAME,
        lambda a, b: math.dist(a.position, b.position) <= _SAME,
        lambda a, b: a.name == b.name and a.role == b.role,
        lambda a, b: a.role == b.role,
    ]
    for test in tests:
        for number, body in enumerate(first):
            likely = [other for other in right if number not in pairs and test(body, other)]
            if likely:
                pairs[number] = min(likely, key=lambda other: math.dist(other.position, body.position))
                right.remove(pairs[number])
    return [*((body, pairs.get(number)) for number, body in enumerate(first)), *((None, other) for other in right)]


def _facts_of_world(scene: GradedScene) -> dict[str, Any]:
    """Kind of fact → what it is in a world."""
    world = scene.world
    return {
        "size": [world.width, world.height],
        "origin": list(scene.bounds[:2]),
        "times": [world.step_time, world.sample_time, world.time_limit],
        "modes": [world.control_mode, world.collision_mode, world.step_mode, world.boundary],
        "map": None if world.obstacle_map is None else str(world.obstacle_map),
        "fog": [world.fog_map, world.fog_map_resolution],
    }


def _facts_of_body(body: GradedBody) -> dict[str, Any]:
    """Kind of fact → what it is for a body, without facts that follow from the whole world."""
    record, sensors = body.record, body.sensors
    return {
        **{kind: getattr(body, kind) for kind in ("role", "kinematics", "options", "color", "name", "passable")},
        "shape": [body.shape, round(float(shapely.area(body.footprint)) > 0)],
        "size": [body.radius] if body.radius is not None else sorted(body.extent),
        "position": list(body.position),
        "heading": _heading(body),
        "goal": [goal[:2] for goal in body.goals],
        "goal_heading": [goal[2:3] for goal in body.goals],
        "way": [[goal[0] - body.pose[0], goal[1] - body.pose[1]] for goal in body.goals],
        "threshold": record.goal_threshold,
        "behavior": [body.behavior, record.wander, record.loop],
        "driven": body.behavior is not None,
        "delays": [record.appear_time, record.start_time],
        "noise": [getattr(record.kinematics, key, None) for key in ("noise", "alpha")],
        "wheelbase": record.wheelbase,
        **{kind: body.ranges.get(kind) for kind in GROUPS["limits"]},
        "acce": body.limits["acce"],
        "fov": [None if record.fov is None else min(record.fov, _FULL_TURN), record.fov_radius],
        "tags": record.tags,
        "sensor_count": len(sensors),
        **{kind: [sensor.get(key) for sensor in sensors] for kind, key in _OF_SENSORS.items()},
        "opening": [min(float(sensor.get("angle_range") or 0.0), _FULL_TURN) for sensor in sensors],
        "sensor_options": [{key: sensor[key] for key in sensor.keys() - _OF_SENSORS.values()} for sensor in sensors],
    }


def _heading(body: GradedBody) -> list[float]:
    """Cosine and sine of the heading; of a fixed rectangle, of the multiple that a turn into itself does not change."""
    times, heading = 1, body.pose[2]
    if body.static and body.role == "obstacle" and body.box is not None:
        times, heading = (4 if body.shape == "square" else 2), body.box.heading
    return [math.cos(times * heading), math.sin(times * heading)]


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_alike(a[key], b[key]) for key in a)
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(_alike(x, y) for x, y in zip(a, b, strict=True))
    if isinstance(a, (int, float)) and isinstance(b, (int, float)) and not isinstance(a, bool):
        return a == b or abs(a - b) <= _SAME
    return bool(a == b)
