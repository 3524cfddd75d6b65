"""Properties of a body that selections and assertions name: how each is computed, what it measures, its key."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

from irsim.options.registry import BEHAVIORS, KINEMATICS
from irsim.scenario.resolve.body_size import top_speed
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.hues import HUES, hue_of
from irsim_evals.grader.matching import Kind, Match, checked
from irsim_evals.grader.scene import GradedScene
from irsim_evals.grader.words import OneOf

__all__ = ["PROPERTIES", "SHAPES", "Having", "Property", "PropertyName", "value_of", "yaml_path"]

_Value = Callable[[GradedScene, GradedBody], Any]


@dataclass(frozen=True)
class Property:
    """One property.

    Attributes:
        kind: Kind of quantity.
        key: Key of the entry that decides it.
        of: Computes it; None where the body has no such property.
        sentence: Its description for authors of cases.
    """

    kind: Kind
    key: str
    of: _Value
    sentence: str


def _goal(component: int) -> _Value:
    return lambda _, body: body.goal[component] if body.goal and len(body.goal) > component else None


def _goal_offset(component: int) -> _Value:
    return lambda _, body: None if body.goal is None else body.goal[component] - body.pose[component]


def _side(name: str) -> _Value:
    """The side of a rectangular body that has the name."""
    return lambda _, body: getattr(body.box, name, None)


def _axis(_: GradedScene, body: GradedBody) -> float | None:
    """Direction of the longer side of a rectangular body; None for squares and other shapes."""
    return None if body.box is None or body.shape == "square" else body.box.heading


def _aspect(_: GradedScene, body: GradedBody) -> float | None:
    """The longer side of a rectangular body divided by the shorter one; infinite for a line."""
    if body.box is None:
        return None
    return body.box.length / body.box.width if body.box.width > 0 else math.inf


def _along(which: int) -> _Value:
    """Extent of a body that is not a disc along (0) or across (1) its own heading."""
    return lambda _, body: None if body.radius is not None else float(body.extent[which])


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


def _of_world(component: int) -> _Value:
    return lambda scene, body: _share(scene, body.position, component)


def _goal_of_world(component: int) -> _Value:
    return lambda scene, body: None if body.goal is None else _share(scene, body.goal, component)


def _range(name: str) -> _Value:
    """The greatest value to one side of what a drive controls."""
    return lambda _, body: body.ranges.get(name)


def _avoids(scene: GradedScene, body: GradedBody) -> bool:
    """Whether its behavior avoids others, all of them or some that there are."""
    roles = {"all", *(other.role for other in scene.bodies if other is not body)}
    return body.avoided in roles


def _acceleration(component: int) -> _Value:
    """The limit of a control's change; None without a limit, and of drives that have no such control."""

    def of(_: GradedScene, body: GradedBody) -> float | None:
        limits = body.limits["acce"] if body.kinematics is not None else []
        has = component == 0 or getattr(body.record.kinematics, "turns", False)
        return limits[component] if limits and has and limits[component] < math.inf else None

    return of


def _is_noisy(_: GradedScene, body: GradedBody) -> bool | None:
    """Whether the drive of a body has noise with a variance other than 0; None without a drive."""
    drive: Any = body.record.kinematics if body.kinematics else None
    return None if drive is None else bool(drive.noise and any(getattr(drive, "alpha", [1.0])))


def _record(name: str) -> _Value:
    return lambda _, body: getattr(body.record, name)


def _is_convex(_: GradedScene, body: GradedBody) -> bool:
    return bool(body.footprint.convex_hull.area <= body.footprint.area * (1 + 1e-6))


def _view(name: str) -> _Value:
    """A measure of its field of view; None where only a lidar has one, which makes no events of a run."""
    return lambda _, body: getattr(body.record, name) if body.record.watches else None


def _shows_fov(_: GradedScene, body: GradedBody) -> bool:
    return bool(body.record.plot.show_fov and body.record.fov is not None and body.record.fov_radius is not None)


def _wanders(_: GradedScene, body: GradedBody) -> bool:
    return body.behavior is not None and body.record.wander


def _loops(scene: GradedScene, body: GradedBody) -> bool:
    """Whether it starts again after its last goal; random goals take precedence."""
    return body.behavior is not None and body.record.loop and not _wanders(scene, body)


def _wheelbase(_: GradedScene, body: GradedBody) -> float | None:
    """As its drive counts it: 1 m for a drive that steers wheels and was given none."""
    steered = body.kinematics is not None and getattr(body.record.kinematics, "steered", False)
    return body.record.wheelbase or (1.0 if steered else body.record.wheelbase)


def _local(_: GradedScene, body: GradedBody) -> str | None:
    """Name of the behavior that drives a planning body from corner to corner."""
    local = body.options.get("local")
    return str(local["name"]) if isinstance(local, dict) and "name" in local else None


PROPERTIES: dict[str, Property] = {
    "name": Property("name", "name", lambda _, body: body.name, "Its name."),
    "role": Property("name", "role", lambda _, body: body.role, "``robot`` or ``obstacle``."),
    "static": Property("flag", "static", lambda _, body: body.static, "Whether it never moves."),
    "passable": Property("flag", "unobstructed", lambda _, body: body.passable, "Whether others pass through it."),
    "kinematics": Property("name", "kinematics", lambda _, body: body.kinematics, "Name of its drive."),
    "wheelbase": Property("size", "kinematics", _wheelbase, "Distance of a car's axles."),
    "shape": Property("name", "shape", lambda _, body: body.shape, "Such as ``square`` or ``line``."),
    "radius": Property("size", "shape", lambda _, body: body.radius, "Radius of a disc."),
    "long_side": Property("size", "shape", _side("length"), "Longer side of a rectangle; length of a line."),
    "short_side": Property("size", "shape", _side("width"), "Shorter side of a rectangle; 0 for a line."),
    "axis": Property("axis", "state", _axis, "Direction of the longer side of a rectangle, or the opposite one."),
    "aspect": Property("size", "shape", _aspect, "Longer side of a rectangle divided by the shorter one."),
    "length": Property("size", "shape", _along(0), "Extent along its own heading; undefined for a disc."),
    "width": Property("size", "shape", _along(1), "Extent across its own heading; undefined for a disc."),
    "area": Property("size", "shape", lambda _, body: float(body.footprint.area), "Area of its outline in m²."),
    "convex": Property("flag", "shape", _is_convex, "Whether its outline has no dents."),
    "x": Property("length", "state", lambda _, body: body.position[0], "Where it starts; of a static body its middle."),
    "y": Property("length", "state", lambda _, body: body.position[1], "Where it starts, as ``x``."),
    "x_share": Property("share", "state", _of_world(0), "``x`` as a share of the world: 0 is its left edge."),
    "y_share": Property("share", "state", _of_world(1), "``y`` as a share of the world: 0 is its lower edge."),
    "heading": Property("heading", "state", lambda _, body: body.pose[2], "Its heading at the start."),
    "goals": Property("count", "goal", lambda _, body: len(body.goals), "How many goals it has, waypoints included."),
    "goal_x": Property("length", "goal", _goal(0), "``x`` of its last goal."),
    "goal_y": Property("length", "goal", _goal(1), "``y`` of its last goal."),
    "goal_x_share": Property("share", "goal", _goal_of_world(0), "``goal_x`` as a share of the world."),
    "goal_y_share": Property("share", "goal", _goal_of_world(1), "``goal_y`` as a share of the world."),
    "goal_heading": Property("heading", "goal", _goal(2), "Heading of its last goal, if the goal has one."),
    "goal_dx": Property("length", "goal", _goal_offset(0), "``goal_x`` less its ``x`` at the start."),
    "goal_dy": Property("length", "goal", _goal_offset(1), "``goal_y`` less its ``y`` at the start."),
    "goal_direction": Property("heading", "goal", _to_goal, "Direction from its start to its last goal."),
    "goal_distance": Property("length", "goal", _straight, "Straight distance from its start to its last goal."),
    "way": Property("length", "goal", _way, "Length of the straight lines from its start over all goals."),
    "threshold": Property("length", "goal_threshold", _record("goal_threshold"), "Distance of arrival."),
    "arrive_mode": Property("name", "arrive_mode", _record("arrive_mode"), "``position`` or ``state``."),
    "behavior": Property("name", "behavior", lambda _, body: body.behavior, "Name of its behavior, or its group's."),
    "options": Property("name", "behavior", lambda _, body: sorted(body.options.items()), "Keys of its behavior."),
    "local": Property("name", "behavior.local", _local, "Name of the behavior between corners of a planned path."),
    "avoids": Property("flag", "behavior", _avoids, "Whether its behavior avoids others."),
    "wander": Property("flag", "behavior.wander", _wanders, "Whether its goals are random."),
    "loop": Property("flag", "behavior.loop", _loops, "Whether it goes round its goals for ever."),
    "forward": Property("speed", "vel_max", _range("forward"), "Greatest speed forwards."),
    "backward": Property("speed", "vel_min", _range("backward"), "Greatest speed backwards, or 0."),
    "sideways": Property("speed", "vel_max", _range("sideways"), "Greatest speed to either side."),
    "turn": Property("rate", "vel_max", _range("turn"), "Greatest turn rate to either side."),
    "steer": Property("angle", "vel_max", _range("steer"), "Greatest steering angle to either side."),
    "leftward": Property("speed", "vel_max", _range("leftward"), "Greatest speed to its left."),
    "rightward": Property("speed", "vel_min", _range("rightward"), "Greatest speed to its right."),
    "turn_left": Property("rate", "vel_max", _range("turn_left"), "Greatest turn rate to the left."),
    "turn_right": Property("rate", "vel_min", _range("turn_right"), "Greatest turn rate to the right."),
    "steer_left": Property("angle", "vel_max", _range("steer_left"), "Greatest steering angle to the left."),
    "steer_right": Property("angle", "vel_min", _range("steer_right"), "Greatest steering angle to the right."),
    "acce": Property("speed", "acce", _acceleration(0), "Greatest change of its speed in a second, if limited."),
    "turn_acce": Property("rate", "acce", _acceleration(-1), "The same of its turn rate or steering angle."),
    "noise": Property("flag", "kinematics.noise", _is_noisy, "Whether its motion is noisy; None without a drive."),
    "top_speed": Property("speed", "vel_max", lambda _, body: float(top_speed(body.record)), "Greatest speed at all."),
    "sensors": Property("count", "sensors", lambda _, body: len(body.sensors), "How many sensors it has."),
    "fov": Property("angle", "fov", _view("fov"), "Angle of its field of view, where that is given."),
    "fov_radius": Property("length", "fov_radius", _view("fov_radius"), "Reach of its ``fov``."),
    "show_fov": Property("flag", "plot.show_fov", _shows_fov, "Whether its field of view is drawn."),
    "color": Property("name", "color", lambda _, body: body.color, "Its color as ``#rrggbb``."),
    "hue": Property("name", "color", lambda _, body: hue_of(body.color), "Its color in a word such as ``red``."),
    "tags": Property("name", "tags", lambda _, body: list(body.record.tags), "Its tags, a list."),
    "group": Property("count", "group", _record("group"), "Number of its group."),
}
"""Name → property."""

SHAPES = ("circle", "square", "rectangle", "line", "polygon", "compound")
"""Values of ``shape``; a square is a rectangle, too."""
_WORDS = {
    "role": ("robot", "obstacle"), "kinematics": KINEMATICS.installed(), "shape": SHAPES, "hue": HUES,
    "arrive_mode": ("position", "state"), "behavior": BEHAVIORS.installed(), "local": BEHAVIORS.installed(),
    "color": ("#rrggbb",),
}  # fmt: skip
"""Property → words that it can be."""


PropertyName = Annotated[str, OneOf("property", PROPERTIES, listed_by="irsim-evals properties explains them all")]
"""Name of a property that there is."""
Having = Annotated[dict[PropertyName, Match], checked({name: one.kind for name, one in PROPERTIES.items()}, _WORDS)]
"""Property → accepted values."""


def value_of(scene: GradedScene, body: GradedBody, name: str) -> Any:
    """The value of a property.

    Raises:
        KeyError: There is no such property.
    """
    return PROPERTIES[name].of(scene, body)


def yaml_path(body: GradedBody, name: str) -> str:
    """Where the value of a property is written: ``robot[0].shape``."""
    return f"{body.entry}.{PROPERTIES[name].key}"
