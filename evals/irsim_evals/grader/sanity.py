"""Requirements of every scenario that is built, whether a prompt says so or not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from irsim.scenario.resolve.body_size import top_speed
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.outcome import Mark, Outcome
from irsim_evals.grader.predicates._base import summary

if TYPE_CHECKING:
    from irsim_evals.grader.episode import GradedEpisode
    from irsim_evals.grader.material import Material
    from irsim_evals.grader.scene import GradedScene

__all__ = ["check_goals", "check_moves", "check_scene", "check_sensors", "latest_start", "overlaps"]

_TOUCH = 1e-6
"""Depth [m] up to which two bodies count as touching."""
_MOVED = 0.05
"""Distance [m] that a body must come to count as moving."""
_NEAR, _NEAR_SHARE = 0.5, 0.05
"""A goal may count as reached at this distance [m], or at this share of the way to it, whichever is more."""
_MAX_DELAY = 60.0
"""Time [s] after which a body that has not come or not started takes no part, if there is no time limit."""
_BESIDE = 0.5
"""A sensor may stand at this distance [m] beside its body."""
_BLIND_SHARE = 0.5
"""Share of its range in which a sensor may be blind."""
_MAX_PAIRS = 200
"""Number of overlapping pairs that are collected."""


def overlaps(material: Material, scene: GradedScene) -> list[tuple[GradedBody, str]]:
    """Bodies that overlap something they must not, with the name of the other, at the start."""
    pairs: list[tuple[GradedBody, str]] = []
    bodies = material.solid_bodies(scene)
    footprints = np.array([body.footprint for body in bodies], dtype=object)
    for i, j in shapely.STRtree(footprints).query(footprints, predicate="intersects").T.tolist():
        a, b = bodies[i], bodies[j]
        fixed = a.static and b.static and not (a.footprint.covers(b.footprint) or b.footprint.covers(a.footprint))
        if i < j and not fixed and _depth(a, b) > _TOUCH and len(pairs) < _MAX_PAIRS:
            pairs.append((b if not b.static else a, a.name if not b.static else b.name))
    terrain = scene.terrain_area
    for body in bodies:
        if body.static or terrain.is_empty or len(pairs) >= _MAX_PAIRS:
            continue
        place = (body.pose[0], body.pose[1])
        inside = body.radius is not None and not scene.is_free(place, body.radius - _TOUCH)
        if inside or (body.radius is None and shapely.intersects(terrain, body.footprint.buffer(-_TOUCH))):
            pairs.append((body, "the map"))
    return pairs


def _depth(a: GradedBody, b: GradedBody) -> float:
    """How deep two footprints reach into one another [m], at least."""
    if a.radius is not None and b.radius is not None:
        return a.radius + b.radius - math.dist(a.position, b.position)
    if shapely.intersects(a.footprint.buffer(-_TOUCH), b.footprint):
        return 2 * _TOUCH
    return 0.0


def check_scene(material: Material, scene: GradedScene, *, overlap: bool = True) -> Iterator[Outcome]:
    """Everything lies in the world and is there in time, may stand still, is solid unless it may be passable, and
    nothing overlaps."""
    x0, y0, x1, y1 = scene.bounds
    moving = [body for body in scene.bodies if not body.static or body.role == "robot"]

    def outside(x: float, y: float) -> bool:
        return not (x0 - _TOUCH <= x <= x1 + _TOUCH and y0 - _TOUCH <= y <= y1 + _TOUCH)

    there = shapely.box(x0, y0, x1, y1)
    starts = [(body, list(body.pose[:2])) for body in moving if outside(body.pose[0], body.pose[1])]
    starts += [(body, list(body.position)) for body in scene.bodies if not there.intersects(body.footprint)]
    goals = [(body, goal[:2]) for body in moving for goal in body.goals if outside(goal[0], goal[1])]
    out = starts + goals
    marks = [Mark(points=[list(point)], text=body.name) for body, point in out]
    key = "state" if starts else "goal"
    yield _outcome("inside-world", "everything lies in the world", out, "all", key, scene.seed, marks)
    restless = [
        (body, f"never goes slower than {body.slowest:g} m/s")
        for body in scene.bodies
        if not body.static and body.slowest > 0
    ]
    yield _outcome("can-stand", "every body may stand still", restless, "all", "vel_min", scene.seed)
    unsolid = [(body, "others pass through it") for body in material.solid_bodies(scene) if body.passable]
    expected = "nothing is passable that the prompt does not make so"
    yield _outcome("solid", expected, unsolid, "nothing", "unobstructed", scene.seed)
    may = {body.index for name in material.late for body in material.bodies(scene, name)}
    late = [
        (body, f"comes after {body.record.appear_time:g} s")
        for body in scene.bodies
        if body.record.appear_time > (0 if body.static and body.index not in may else _longest_delay(scene))
    ]
    expected = "what never moves is there from the start, and what moves comes before the end"
    yield _outcome("present", expected, late, "all", "appear_time", scene.seed)
    if overlap:
        both = [(body, f"overlaps {other}") for body, other in overlaps(material, scene)]
        yield _outcome("no-overlap", "nothing overlaps at the start", both, "nothing", "state", scene.seed)


def _longest_delay(scene: GradedScene) -> float:
    limit = scene.world.time_limit
    return _MAX_DELAY if limit is None else float(limit)


def latest_start(scene: GradedScene) -> float:
    """Time [s] at which the last body starts that takes part at all."""
    delays = [max(body.record.start_time, body.record.appear_time) for body in scene.bodies if not body.static]
    return max((delay for delay in delays if delay <= _longest_delay(scene)), default=0.0)


def check_sensors(scene: GradedScene) -> Outcome:
    """Sensors sit on their bodies and see what is near, too."""
    odd = []
    for body in scene.bodies:
        for sensor in body.sensors:
            away = math.hypot(*(sensor.get("offset") or [0.0, 0.0])[:2])
            if away > max(body.extent) + _BESIDE:
                odd.append((body, f"a sensor stands {away:.1f} m away"))
            elif sensor.get("range_min", 0.0) > _BLIND_SHARE * sensor.get("range_max", math.inf):
                odd.append((body, f"a sensor sees nothing nearer than {sensor['range_min']:g} m"))
    expected = "sensors sit on their bodies and see what is near"
    return _outcome("sensors-see", expected, odd, "so it is", "sensors", scene.seed)


def check_goals(scene: GradedScene, *, in_time: bool = True) -> Outcome:
    """Goals mean something: they count as reached only near them, and some robot has time enough for its way, unless
    the case is about one that has not."""
    limit = scene.world.time_limit
    bodies = [b for b in scene.bodies if not b.static and b.behavior is not None and b.goals and not b.record.wander]
    ways = [(body, math.dist(body.pose[:2], body.goals[-1][:2])) for body in bodies]
    odd = [
        (body, f"has arrived nearer than {body.record.goal_threshold:g} m")
        for body, way in ways
        if not 0 < body.record.goal_threshold <= max(_NEAR, _NEAR_SHARE * way)
    ]
    odd += [
        (body, "is at its goal from the start")
        for body, _ in ways
        if all(math.dist(body.pose[:2], goal[:2]) <= body.record.goal_threshold for goal in body.goals)
    ]
    key = "goal_threshold"
    robots = [(body, way) for body, way in ways if body.role == "robot"]
    reach = [
        math.inf if limit is None else limit * top_speed(body.record) + body.record.goal_threshold for body, _ in robots
    ]
    late = [(body, way) for (body, way), far in zip(robots, reach, strict=True) if way > far]
    if in_time and late and len(late) == len(robots):
        key = key if odd else "world.time_limit"
        odd += [(body, f"has {limit:g} s for {way:.1f} m") for body, way in late]
    expected = "goals count as reached only near them, and the time limit leaves room for the way"
    return _outcome("goals-count", expected, odd, "so it is", key, scene.seed, [])


def check_moves(episode: GradedEpisode) -> Outcome:
    """Every body with a goal and a behavior moves, unless it is already there."""
    still = []
    for body in episode.scene.bodies:
        if body.static or body.behavior is None or not (body.goals or body.record.wander):
            continue
        near = body.goal is not None and math.dist(body.pose[:2], body.goal[:2]) <= body.record.goal_threshold + _MOVED
        path = episode.path(body.index)
        if not near and np.hypot(*(path - path[:1]).T).max(initial=0.0) < _MOVED:
            still.append((body, "stays where it is"))
    expected = "every body with a goal and a behavior moves"
    return _outcome("moves", expected, still, "all", "behavior", episode.seed)


def _outcome(
    name: str, expected: str, odd: Sequence[tuple[GradedBody, Any]], right: str, key: str, seed: int,
    marks: list[Mark] | None = None,
) -> Outcome:  # fmt: skip
    """The outcome of something that must hold for every body.

    Args:
        name: Name of the assertion.
        expected: The requirement.
        odd: Bodies for which it does not, with what was seen instead.
        right: The observed value if it holds for all.
        key: Key of the entry that decides; one with a dot in it is a whole path.
        seed: Seed of the world.
        marks: Places for the picture; default: the bodies' positions.
    """
    if marks is None:
        marks = [Mark(points=[list(body.position)], text=body.name) for body, _ in odd]
    where = None if not odd else key if "." in key else f"{odd[0][0].entry}.{key}"
    return Outcome(
        assertion=name, stage="sane", passed=not odd, expected=expected, observed=summary(odd) or right,
        yaml_path=where, seed=seed, marks=marks,
    )  # fmt: skip
