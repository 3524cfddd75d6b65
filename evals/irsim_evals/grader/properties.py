"""Properties of a body that selections and assertions name: how each is computed, what it measures, its key."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator

from irsim.scenario.resolve.body_size import top_speed
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.hues import hue_of
from irsim_evals.grader.matching import Kind
from irsim_evals.grader.scene import GradedScene

__all__ = ["PROPERTIES", "Property", "PropertyName", "value_of", "yaml_path"]


@dataclass(frozen=True)
class Property:
    """One property.

    Attributes:
        kind: Kind of quantity.
        key: Key of the entry that decides it.
        of: Computes it; None where the body has no such property.
    """

    kind: Kind
    key: str
    of: Callable[[GradedScene, GradedBody], Any]


def _goal(component: int) -> Callable[[GradedScene, GradedBody], Any]:
    def of(_: GradedScene, body: GradedBody) -> float | None:
        goal = body.goal
        return None if goal is None or len(goal) <= component else goal[component]

    return of


def _goal_offset(component: int) -> Callable[[GradedScene, GradedBody], Any]:
    def of(_: GradedScene, body: GradedBody) -> float | None:
        return None if body.goal is None else body.goal[component] - body.pose[component]

    return of


def _side(which: int) -> Callable[[GradedScene, GradedBody], Any]:
    """The longer (0) or shorter (1) side of a rectangular body."""

    def of(_: GradedScene, body: GradedBody) -> float | None:
        if body.box is None:
            return None
        return (body.box.length, body.box.width)[which]

    return of


def _axis(_: GradedScene, body: GradedBody) -> float | None:
    """Direction of the longer side of a rectangular body; None for squares and other shapes."""
    return None if body.box is None or body.shape == "square" else body.box.heading


def _aspect(_: GradedScene, body: GradedBody) -> float | None:
    """The longer side of a rectangular body divided by the shorter one; infinite for a line."""
    if body.box is None:
        return None
    return body.box.length / body.box.width if body.box.width > 0 else math.inf


def _along(which: int) -> Callable[[GradedScene, GradedBody], Any]:
    """Extent of a body that is not a disc along (0) or across (1) its own heading."""

    def of(_: GradedScene, body: GradedBody) -> float | None:
        return None if body.radius is not None else float(body.extent[which])

    return of


def _way(_: GradedScene, body: GradedBody) -> float | None:
    """Straight distance from the start over all goals."""
    points = [body.pose[:2], *(goal[:2] for goal in body.goals)]
    return sum(math.dist(a, b) for a, b in itertools.pairwise(points)) if body.goals else None


def _straight(_: GradedScene, body: GradedBody) -> float | None:
    return None if body.goal is None else math.dist(body.pose[:2], body.goal[:2])


def _to_goal(_: GradedScene, body: GradedBody) -> float | None:
    """Direction from the start to the last goal."""
    goal = body.goal
    return None if goal is None else math.atan2(goal[1] - body.pose[1], goal[0] - body.pose[0])


def _share(scene: GradedScene, point: Sequence[float], component: int) -> float:
    """A coordinate as a share of the extent of the world."""
    low, high = scene.bounds[component], scene.bounds[component + 2]
    return (point[component] - low) / (high - low)


def _of_world(component: int) -> Callable[[GradedScene, GradedBody], Any]:
    return lambda scene, body: _share(scene, body.position, component)


def _goal_of_world(component: int) -> Callable[[GradedScene, GradedBody], Any]:
    return lambda scene, body: None if body.goal is None else _share(scene, body.goal, component)


def _limit(kinematics: tuple[str, ...], component: int, sign: int) -> Callable[[GradedScene, GradedBody], Any]:
    """Greatest control of a component in one direction (1: forward, left; -1: backward, right)."""

    def of(_: GradedScene, body: GradedBody) -> float | None:
        values = body.limits.get("vel_max" if sign > 0 else "vel_min", [])
        if body.kinematics not in kinematics or len(values) <= component:
            return None
        return max(0.0, sign * values[component])

    return of


def _local(_: GradedScene, body: GradedBody) -> str | None:
    """Name of the behavior that drives a planning body from corner to corner."""
    local = body.options.get("local")
    return str(local["name"]) if isinstance(local, dict) and "name" in local else None


def _turn(scene: GradedScene, body: GradedBody, sign: int) -> float | None:
    component = 1 if body.kinematics == "diff" else 2
    limit: float | None = _limit(("diff", "omni_angular"), component, sign)(scene, body)
    return limit


PROPERTIES: dict[str, Property] = {
    "name": Property("name", "name", lambda _, body: body.name),
    "role": Property("name", "role", lambda _, body: body.role),
    "static": Property("flag", "static", lambda _, body: body.static),
    "passable": Property("flag", "unobstructed", lambda _, body: body.passable),
    "kinematics": Property("name", "kinematics", lambda _, body: body.kinematics),
    "wheelbase": Property("size", "kinematics", lambda _, body: body.record.wheelbase),
    "shape": Property("name", "shape", lambda _, body: body.shape),
    "radius": Property("size", "shape", lambda _, body: body.radius),
    "long_side": Property("size", "shape", _side(0)),
    "short_side": Property("size", "shape", _side(1)),
    "axis": Property("axis", "state", _axis),
    "aspect": Property("size", "shape", _aspect),
    "length": Property("size", "shape", _along(0)),
    "width": Property("size", "shape", _along(1)),
    "area": Property("size", "shape", lambda _, body: float(body.footprint.area)),
    "convex": Property(
        "flag", "shape", lambda _, body: body.footprint.convex_hull.area <= body.footprint.area * (1 + 1e-6)
    ),
    "x": Property("length", "state", lambda _, body: body.position[0]),
    "y": Property("length", "state", lambda _, body: body.position[1]),
    "x_share": Property("share", "state", _of_world(0)),
    "y_share": Property("share", "state", _of_world(1)),
    "heading": Property("heading", "state", lambda _, body: body.pose[2]),
    "goals": Property("count", "goal", lambda _, body: len(body.goals)),
    "goal_x": Property("length", "goal", _goal(0)),
    "goal_y": Property("length", "goal", _goal(1)),
    "goal_x_share": Property("share", "goal", _goal_of_world(0)),
    "goal_y_share": Property("share", "goal", _goal_of_world(1)),
    "goal_heading": Property("heading", "goal", _goal(2)),
    "goal_dx": Property("length", "goal", _goal_offset(0)),
    "goal_dy": Property("length", "goal", _goal_offset(1)),
    "goal_direction": Property("heading", "goal", _to_goal),
    "goal_distance": Property("length", "goal", _straight),
    "way": Property("length", "goal", _way),
    "threshold": Property("length", "goal_threshold", lambda _, body: body.record.goal_threshold),
    "arrive_mode": Property("name", "arrive_mode", lambda _, body: body.record.arrive_mode),
    "behavior": Property("name", "behavior", lambda _, body: body.behavior),
    "options": Property("name", "behavior", lambda _, body: sorted(body.options.items(), key=str)),
    "local": Property("name", "behavior.local", _local),
    "avoids": Property("flag", "behavior", lambda _, body: body.avoids),
    "wander": Property("flag", "behavior.wander", lambda _, body: body.record.wander),
    "loop": Property("flag", "behavior.loop", lambda _, body: body.record.loop),
    "forward": Property("speed", "vel_max", lambda _, body: body.forward),
    "backward": Property("speed", "vel_min", lambda _, body: body.backward),
    "sideways": Property("speed", "vel_max", lambda _, body: body.sideways),
    "turn": Property("rate", "vel_max", lambda _, body: body.turn),
    "steer": Property("angle", "vel_max", lambda _, body: body.steer),
    "leftward": Property("speed", "vel_max", _limit(("omni", "omni_angular"), 1, 1)),
    "rightward": Property("speed", "vel_min", _limit(("omni", "omni_angular"), 1, -1)),
    "turn_left": Property("rate", "vel_max", lambda s, b: _turn(s, b, 1)),
    "turn_right": Property("rate", "vel_min", lambda s, b: _turn(s, b, -1)),
    "steer_left": Property("angle", "vel_max", _limit(("acker",), 1, 1)),
    "steer_right": Property("angle", "vel_min", _limit(("acker",), 1, -1)),
    "top_speed": Property("speed", "vel_max", lambda _, body: float(top_speed(body.record))),
    "sensors": Property("count", "sensors", lambda _, body: len(body.sensors)),
    "fov": Property("angle", "fov", lambda _, body: body.record.fov),
    "fov_radius": Property("length", "fov_radius", lambda _, body: body.record.fov_radius),
    "color": Property("name", "color", lambda _, body: body.color),
    "hue": Property("name", "color", lambda _, body: hue_of(body.color)),
    "tags": Property("name", "tags", lambda _, body: list(body.record.tags)),
    "group": Property("count", "group", lambda _, body: body.record.group),
}
"""Name → property."""


def _known(name: str) -> str:
    if name not in PROPERTIES:
        raise ValueError(f"no property is called {name!r}; there are {', '.join(PROPERTIES)}")
    return name


PropertyName = Annotated[str, AfterValidator(_known)]
"""Name of a property that there is."""


def value_of(scene: GradedScene, body: GradedBody, name: str) -> Any:
    """The value of a property.

    Raises:
        KeyError: There is no such property.
    """
    return PROPERTIES[name].of(scene, body)


def yaml_path(body: GradedBody, name: str) -> str:
    """Where the value of a property is written: ``robot[0].shape``."""
    return f"{body.entry}.{PROPERTIES[name].key}"
